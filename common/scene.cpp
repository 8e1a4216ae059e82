#include "common/scene.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>

#include "common/error.hpp"
#include "common/mesh.hpp"
#include "common/nearest_word.hpp"
#include "common/text_file.hpp"

namespace palpate {
namespace {

using Words = std::span<const std::string_view>;

constexpr std::array<std::string_view, 3> unit_words = {"m", "cm", "mm"};
constexpr std::array<double, 3> unit_metres = {1.0, 0.01, 0.001};
constexpr std::array<std::string_view, 3> axis_words = {"x", "y", "z"};

/// "; did you mean \"spacing\"?", or what there is when nothing is near.
std::string hint(std::string_view word, Words words) {
  const std::string_view nearest = nearestWord(word, words);
  if (nearest.empty()) return fmt::format("; there is {}", listed(words));
  return fmt::format("; did you mean \"{}\"?", nearest);
}

/// What every value needs to be read: the name of the file for errors and the unit of its lengths.
struct Context {
  std::string source;
  double metres_per_unit = 1;
};

/// One table of the file. Constructing it refuses keys that are not among `keys`. Every error names file,
/// line and key.
class Section {
 public:
  Section(const Context& context, const toml::table& table, std::string name,
          std::initializer_list<std::string_view> keys)
      : context_(context), table_(table), name_(std::move(name)) {
    for (const auto& [key, node] : table_)
      if (std::find(keys.begin(), keys.end(), key.str()) == keys.end())
        throw badInput("{}:{}: unknown key \"{}\"{}", context_.source, node.source().begin.line,
                       pathOf(key.str()), hint(key.str(), Words(keys.begin(), keys.size())));
  }

  const Context& context() const { return context_; }
  const toml::node* find(std::string_view key) const { return table_.get(key); }
  bool has(std::string_view key) const { return find(key) != nullptr; }

  const toml::node& require(std::string_view key, std::string_view meaning) const {
    if (const toml::node* node = find(key)) return *node;
    throw badInput("{}: \"{}\" is missing: {}", place(table_), pathOf(key), meaning);
  }

  template <class... Args>
  Error wrong(std::string_view key, fmt::format_string<Args...> format, Args&&... args) const {
    const toml::node* node = find(key);
    return badInput("{}: {}: {}", place(node ? *node : static_cast<const toml::node&>(table_)), pathOf(key),
                    fmt::format(format, std::forward<Args>(args)...));
  }

  double number(std::string_view key, const toml::node& node) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value) throw wrong(key, "a number is expected, not {}", kindOf(node));
    if (!std::isfinite(*value)) throw wrong(key, "must be finite");
    return *value;
  }

  double positive(std::string_view key, std::string_view meaning) const {
    const double value = number(key, require(key, meaning));
    if (!(value > 0)) throw wrong(key, "{} must be greater than 0", value);
    return value;
  }

  double positiveLength(std::string_view key, std::string_view meaning) const {
    return metres(positive(key, meaning));
  }

  double metres(double length) const { return toMetres(length, context_.metres_per_unit); }

  std::int32_t nodeNumber(std::string_view key, const toml::node& node) const {
    const auto value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
    if (!value) throw wrong(key, "a node number (an integer) is expected, not {}", kindOf(node));
    if (*value < 0 || *value > std::numeric_limits<std::int32_t>::max())
      throw wrong(key, "node number {} cannot be; nodes are counted from 0", *value);
    return static_cast<std::int32_t>(*value);
  }

  std::string text(std::string_view key, const toml::node& node) const {
    const auto value = node.is_string() ? node.value<std::string>() : std::nullopt;
    if (!value) throw wrong(key, "text in quotes is expected, not {}", kindOf(node));
    if (value->empty()) throw wrong(key, "must not be empty");
    return *value;
  }

  bool flag(std::string_view key, bool otherwise) const {
    const toml::node* node = find(key);
    if (node == nullptr) return otherwise;
    if (!node->is_boolean()) throw wrong(key, "true or false is expected, not {}", kindOf(*node));
    return *node->value<bool>();
  }

  /// The position in `words` of the word that `key` holds.
  std::size_t choice(std::string_view key, const toml::node& node, Words words) const {
    const std::string value = text(key, node);
    const auto found = std::find(words.begin(), words.end(), value);
    if (found == words.end()) throw wrong(key, "there is no \"{}\"{}", value, hint(value, words));
    return static_cast<std::size_t>(found - words.begin());
  }

  /// Three lengths, in metres.
  Eigen::Vector3d point(std::string_view key, const toml::node& node) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != 3) throw wrong(key, "three numbers [x, y, z] are expected");
    Eigen::Vector3d p;
    for (std::size_t i = 0; i < 3; ++i) p[static_cast<Eigen::Index>(i)] = metres(number(key, *array->get(i)));
    return p;
  }

  /// `key` as a list: nothing when it is absent, its elements when it is an array, else itself alone.
  std::vector<const toml::node*> oneOrMany(std::string_view key) const {
    std::vector<const toml::node*> nodes;
    const toml::node* node = find(key);
    if (node == nullptr) return nodes;
    const toml::array* array = node->as_array();
    if (array == nullptr) return {node};
    if (array->empty()) throw wrong(key, "the list is empty");
    for (const toml::node& element : *array) nodes.push_back(&element);
    return nodes;
  }

  Section inner(std::string_view key, const toml::node& node,
                std::initializer_list<std::string_view> keys) const {
    const toml::table* table = node.as_table();
    if (table == nullptr) throw wrong(key, "a table is expected, not {}", kindOf(node));
    return {context_, *table, pathOf(key), keys};
  }

 private:
  static std::string kindOf(const toml::node& node) {
    switch (node.type()) {
      case toml::node_type::table:
        return "a table";
      case toml::node_type::array:
        return "a list";
      case toml::node_type::string:
        return "text";
      case toml::node_type::integer:
      case toml::node_type::floating_point:
        return "a number";
      case toml::node_type::boolean:
        return "true or false";
      default:
        return "a date or time";
    }
  }

  std::string pathOf(std::string_view key) const {
    return name_.empty() ? std::string(key) : fmt::format("{}.{}", name_, key);
  }

  std::string place(const toml::node& node) const {
    const auto line = node.source().begin.line;
    return line > 0 ? fmt::format("{}:{}", context_.source, line) : context_.source;
  }

  const Context& context_;
  const toml::table& table_;
  std::string name_;
};

void refuse(const Section& section, std::initializer_list<std::string_view> keys, LawName law) {
  for (const std::string_view key : keys)
    if (section.has(key))
      throw section.wrong(key, "law \"{}\" does not take it; it takes {}", word(law),
                          law == LawName::mooney_rivlin ? "c10 and c01" : "young and poisson");
}

double poissonOf(const Section& section) {
  const double poisson = section.number(
      "poisson", section.require("poisson", "Poisson's ratio, greater than -1 and less than 0.5"));
  if (!(poisson > -1 && poisson < 0.5))
    throw section.wrong(
        "poisson",
        "{} must be greater than -1 and less than 0.5 (an incompressible tissue has a law of its own: "
        "modified-st-venant-kirchhoff or mooney-rivlin)",
        poisson);
  return poisson;
}

Material readMaterial(const Section& section) {
  Material material;
  const toml::node& law = section.require("law", fmt::format("write one of {}", listed(lawWords())));
  material.law = static_cast<LawName>(section.choice("law", law, lawWords()));
  if (material.law == LawName::mooney_rivlin) {
    refuse(section, {"young", "poisson"}, material.law);
    material.c10 = section.positive("c10", "the first Mooney-Rivlin constant, Pa");
    material.c01 = section.number(
        "c01", section.require("c01", "the second Mooney-Rivlin constant, Pa (0: neo-Hookean)"));
    if (material.c01 < 0) throw section.wrong("c01", "{} must not be negative", material.c01);
    return material;
  }
  refuse(section, {"c10", "c01"}, material.law);
  material.young = section.positive("young", "Young's modulus, Pa");
  if (material.law != LawName::modified_st_venant_kirchhoff || section.has("poisson"))
    material.poisson = poissonOf(section);
  return material;
}

Discretization readDiscretization(const Section* section, const Material& material) {
  const LawName law = material.law;
  Discretization d;
  d.pressure = isIncompressible(material) ? PressureSpace::p1_stabilized : PressureSpace::none;
  if (section == nullptr) return d;
  if (const toml::node* node = section->find("displacement"))
    section->choice("displacement", *node, displacementWords());
  if (const toml::node* node = section->find("constraint"))
    d.constraint = static_cast<Constraint>(section->choice("constraint", *node, constraintWords()));
  if (const toml::node* node = section->find("pressure"))
    d.pressure = static_cast<PressureSpace>(section->choice("pressure", *node, pressureWords()));
  if (isIncompressible(material) && d.pressure == PressureSpace::none)
    throw section->wrong("pressure", "law \"{}\" is incompressible and needs a pressure: P1-stabilized or P1",
                         word(law));
  if (!isIncompressible(material) && d.pressure != PressureSpace::none)
    throw section->wrong("pressure",
                         "law \"{}\" is compressible and takes no pressure: write none, or leave it out",
                         word(law));
  return d;
}

HalfSpace readHalfSpace(const Section& section, bool below) {
  HalfSpace half;
  half.below = below;
  half.axis =
      static_cast<int>(section.choice("axis", section.require("axis", "write x, y or z"), axis_words));
  if (section.has("fraction") == section.has("at"))
    throw section.wrong("fraction",
                        "give either fraction (of the bounding box, 0 to 1) or at (a coordinate)");
  if (const toml::node* at = section.find("at")) {
    half.at = section.metres(section.number("at", *at));
    return half;
  }
  half.fraction = section.number("fraction", *section.find("fraction"));
  if (!(*half.fraction > 0 && *half.fraction <= 1))
    throw section.wrong("fraction", "{} must be greater than 0 and at most 1", *half.fraction);
  return half;
}

Box readBox(const Section& section) {
  Box box = {
      section.point("lowest", section.require("lowest", "the corner [x, y, z] with the lowest coordinates")),
      section.point("highest",
                    section.require("highest", "the corner [x, y, z] with the highest coordinates"))};
  if ((box.lowest.array() > box.highest.array()).any())
    throw section.wrong("lowest", "a coordinate is greater than that of highest");
  return box;
}

Sphere readSphere(const Section& section) {
  return {section.point("center", section.require("center", "[x, y, z]")),
          section.positiveLength("radius", "its radius")};
}

FixedSelection readFixed(const Section& section) {
  FixedSelection fixed;
  for (const bool below : {true, false}) {
    const std::string_view key = below ? "below" : "above";
    for (const toml::node* node : section.oneOrMany(key))
      fixed.half_spaces.push_back(
          readHalfSpace(section.inner(key, *node, {"axis", "fraction", "at"}), below));
  }
  for (const toml::node* node : section.oneOrMany("box"))
    fixed.boxes.push_back(readBox(section.inner("box", *node, {"lowest", "highest"})));
  for (const toml::node* node : section.oneOrMany("sphere"))
    fixed.spheres.push_back(readSphere(section.inner("sphere", *node, {"center", "radius"})));
  for (const toml::node* node : section.oneOrMany("group"))
    fixed.groups.push_back(section.text("group", *node));
  for (const toml::node* node : section.oneOrMany("nodes"))
    fixed.nodes.push_back(section.nodeNumber("nodes", *node));
  return fixed;
}

bool isPlainName(const std::string& name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
}

ActiveSelection readActive(const Section& section) {
  ActiveSelection active;
  active.name = section.text("name", section.require("name", "every active node needs a name"));
  if (!isPlainName(active.name))
    throw section.wrong("name", "\"{}\" may hold letters, digits, - and _ only", active.name);
  if (section.has("near") == section.has("node"))
    throw section.wrong("near",
                        "give either near = [x, y, z] (the nearest surface node is taken) or node = NUMBER");
  if (const toml::node* near = section.find("near")) active.near = section.point("near", *near);
  if (const toml::node* node = section.find("node")) active.node = section.nodeNumber("node", *node);
  if (const toml::node* radius = section.find("radius")) {
    const double value = section.number("radius", *radius);
    if (value < 0) throw section.wrong("radius", "{} must not be negative", value);
    active.radius = section.metres(value);
  }
  return active;
}

std::vector<ActiveSelection> readActives(const Section& root) {
  const toml::node& node = root.require("active", "write one [[active]] table for each active node");
  const toml::array* array = node.as_array();
  if (array == nullptr || array->empty())
    throw root.wrong("active", "write [[active]], in double brackets, once for each active node");
  std::vector<ActiveSelection> actives;
  for (const toml::node& element : *array) {
    const Section section = root.inner("active", element, {"name", "near", "node", "radius"});
    actives.push_back(readActive(section));
    const auto same = [&](const ActiveSelection& other) { return other.name == actives.back().name; };
    if (std::any_of(actives.begin(), actives.end() - 1, same))
      throw section.wrong("name", "two active nodes are called \"{}\"", actives.back().name);
  }
  return actives;
}

Workspace readWorkspace(const Section& section) {
  Workspace workspace;
  if (section.has("radius")) workspace.radius = section.positiveLength("radius", "");
  if (section.has("spacing")) workspace.spacing = section.positiveLength("spacing", "");
  if (section.has("max_force")) workspace.max_force = section.positive("max_force", "");
  workspace.reject_inverted = section.flag("reject_inverted", workspace.reject_inverted);
  if (workspace.radius < workspace.spacing)
    throw section.wrong(
        "radius", "{} m is smaller than the spacing of {} m: the lattice would be the rest position alone",
        workspace.radius, workspace.spacing);
  return workspace;
}

Scene readTables(const toml::table& table, const std::string& source) {
  Context context{source};
  const Section root(
      context, table, "",
      {"name", "mesh", "length_unit", "material", "discretization", "fixed", "active", "workspace"});
  if (const toml::node* unit = root.find("length_unit"))
    context.metres_per_unit = unit_metres[root.choice("length_unit", *unit, unit_words)];

  Scene scene;
  scene.metres_per_unit = context.metres_per_unit;
  const toml::node* name = root.find("name");
  scene.name = name ? root.text("name", *name) : std::filesystem::path(source).stem().string();
  scene.mesh = root.text("mesh", root.require("mesh", "the mesh file, relative to the scene file"));
  scene.regions[0].material =
      readMaterial(root.inner("material", root.require("material", "write a [material] table"),
                              {"law", "c10", "c01", "young", "poisson"}));
  std::optional<Section> discretization;
  if (const toml::node* node = root.find("discretization"))
    discretization.emplace(root.inner("discretization", *node, {"displacement", "pressure", "constraint"}));
  scene.discretization =
      readDiscretization(discretization ? &*discretization : nullptr, scene.regions[0].material);
  scene.fixed = readFixed(
      root.inner("fixed", root.require("fixed", "write a [fixed] table that says which nodes are held"),
                 {"below", "above", "box", "sphere", "group", "nodes"}));
  scene.active = readActives(root);
  if (const toml::node* node = root.find("workspace"))
    scene.workspace =
        readWorkspace(root.inner("workspace", *node, {"radius", "spacing", "max_force", "reject_inverted"}));
  return scene;
}

}  // namespace

bool isInfSupStable(const Discretization& discretization) {
  const bool equal_order = discretization.displacement == DisplacementSpace::p1
                               ? discretization.pressure == PressureSpace::p1
                               : discretization.pressure == PressureSpace::p2;
  return !equal_order;
}

Scene parseScene(const std::string& text, const std::string& source) {
  try {
    return readTables(toml::parse(text, source), source);
  } catch (const toml::parse_error& error) {
    throw badInput("{}:{}: not TOML: {}", source, error.source().begin.line, error.description());
  }
}

Scene readScene(const std::filesystem::path& file) {
  Scene scene = parseScene(readText(file, "scene"), file.string());
  scene.mesh = std::filesystem::absolute(file.parent_path() / scene.mesh).lexically_normal();
  return scene;
}

}  // namespace palpate
