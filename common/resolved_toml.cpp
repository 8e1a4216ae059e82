// The scene as it stands in messages and datasets; read again by scene.cpp.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/scene.hpp"

namespace palpate {
namespace {

/// The shortest decimal that is read back as the same double, always a TOML float.
std::string decimal(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string decimal(const Eigen::Vector3d& v) {
  return fmt::format("[{}, {}, {}]", decimal(v[0]), decimal(v[1]), decimal(v[2]));
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      (out += '\\') += c;
    else if (code < 0x20 || code == 0x7f)
      out += fmt::format("\\u{:04X}", code);
    else
      out += c;
  }
  return out + "\"";
}

/// `key = [item, ...]`, one item per line; nothing for no items.
std::string listOf(const char* key, const std::vector<std::string>& items) {
  if (items.empty()) return {};
  std::string text = fmt::format("{} = [\n", key);
  for (const std::string& item : items) text += "  " + item + ",\n";
  return text + "]\n";
}

std::string materialToml(const Material& m) {
  std::string text = fmt::format("\n[material]\nlaw = \"{}\"\n", word(m.law));
  if (m.law == LawName::mooney_rivlin)
    return text + fmt::format("c10 = {}  # Pa\nc01 = {}  # Pa\n", decimal(m.c10), decimal(m.c01));
  text += fmt::format("young = {}  # Pa\n", decimal(m.young));
  if (m.poisson) text += fmt::format("poisson = {}\n", decimal(*m.poisson));
  return text;
}

std::string fixedToml(const FixedSelection& fixed) {
  std::vector<std::string> below, above, boxes, spheres, groups, nodes;
  for (const HalfSpace& half : fixed.half_spaces)
    (half.below ? below : above)
        .push_back(fmt::format("{{ axis = \"{}\", {} = {} }}", "xyz"[half.axis], half.at ? "at" : "fraction",
                               decimal(half.at ? *half.at : *half.fraction)));
  for (const Box& box : fixed.boxes)
    boxes.push_back(
        fmt::format("{{ lowest = {}, highest = {} }}", decimal(box.lowest), decimal(box.highest)));
  for (const Sphere& sphere : fixed.spheres)
    spheres.push_back(
        fmt::format("{{ center = {}, radius = {} }}", decimal(sphere.center), decimal(sphere.radius)));
  for (const std::string& group : fixed.groups) groups.push_back(quoted(group));
  std::string text = "\n[fixed]\n" + listOf("below", below) + listOf("above", above) + listOf("box", boxes) +
                     listOf("sphere", spheres) + listOf("group", groups);
  if (!fixed.nodes.empty()) text += fmt::format("nodes = [{}]\n", fmt::join(fixed.nodes, ", "));
  return text;
}

std::string activeToml(const ActiveSelection& active) {
  return fmt::format("\n[[active]]\nname = {}\n{}\nradius = {}  # m\n", quoted(active.name),
                     active.near ? fmt::format("near = {}  # m", decimal(*active.near))
                                 : fmt::format("node = {}", *active.node),
                     decimal(active.radius));
}

}  // namespace

std::string resolvedToml(const Scene& scene) {
  std::string text = fmt::format("name = {}\nmesh = {}\nlength_unit = \"m\"\n", quoted(scene.name),
                                 quoted(scene.mesh.filename().string()));
  text += materialToml(scene.regions[0].material);
  text += fmt::format("\n[discretization]\ndisplacement = \"P1\"\npressure = \"{}\"\nconstraint = \"{}\"\n",
                      word(scene.discretization.pressure), word(scene.discretization.constraint));
  text += fixedToml(scene.fixed);
  for (const ActiveSelection& active : scene.active) text += activeToml(active);
  const Workspace& w = scene.workspace;
  text += fmt::format(
      "\n[workspace]\nradius = {}  # m\nspacing = {}  # m\nmax_force = {}  # N\nreject_inverted = {}\n",
      decimal(w.radius), decimal(w.spacing), decimal(w.max_force), w.reject_inverted);
  return text;
}

}  // namespace palpate
