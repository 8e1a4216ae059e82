#include "worker/meshing/proposed_scene.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/mesh/mesh_text.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/problem.hpp"
#include "common/problem/problem_warnings.hpp"
#include "common/scene/device_profile.hpp"

namespace palpate {
namespace {

/// Words in the name of a node group that suggest that it is fixed, the most telling first.
constexpr const char* words_of_fixed[] = {"fix",  "clamp",  "encastre", "support",
                                          "held", "anchor", "ground",   "attach",
                                          "base", "bottom", "bone",     "ligament"};
/// Largest share of the surface's nodes that a fixed group may contain. A larger group would hold
/// too much of the body.
constexpr double most_fixed = 0.6;
/// Length of the fixed end, as a fraction of the body's longest extent.
constexpr double fixed_end = 0.15;
/// Wanted radius of the finger, in mean edges of the surface. While there are warnings, these
/// shares of the radius are tried one after another.
constexpr double wanted_edges = 1.5;
constexpr double finger_shares[] = {1, 0.85, 0.75, 0.67, 1.3, 1.7, 2.2};
/// Largest surface area in units of the finger's radius^2. There are about 1.7 area / radius^2
/// sites, so this limits their number to about 330.
constexpr double area_per_finger = 190;
/// Largest number of sites that a smaller finger may need. More sites would make a first build
/// long.
constexpr double most_places = 1000;
constexpr const DeviceProfile& proposed_device = device_profiles.front();
/// The proposed tissue, Pa, and its Young's modulus.
constexpr double c10 = 1300, c01 = 1280, tissue_young = 6 * (c10 + c01);
/// At most places, a finger of radius r feels the force F at the depth 1.6 F / (E r), where E is
/// Young's modulus. Measured on livers.
constexpr double force_depth = 1.6;
/// Largest depth of the workspace in radii of the finger. Deeper pushes would tear the tissue.
constexpr double deepest = 1.5;

struct FixedProposal {
  std::string toml, why;
};

/// Returns whether a word of the name begins with `word`: "BC_Fixed" and "fixedNodes" match "fix",
/// "prefix" does not.
bool nameSays(const std::string& name, std::string_view word) {
  std::string lower;
  char before = ' ';
  for (const char c : name) {
    const auto is = [](int (*kind)(int), char letter) {
      return kind(static_cast<unsigned char>(letter)) != 0;
    };
    if (!is(std::isalpha, c) || (is(std::isupper, c) && is(std::islower, before))) lower += ' ';
    if (is(std::isalpha, c))
      lower += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    before = c;
  }
  return (" " + lower).find(" " + std::string(word)) != std::string::npos;
}

std::optional<std::string> fixedGroup(const Mesh& mesh) {
  const NodeSet surface = surfaceNodes(mesh);
  for (const char* word : words_of_fixed)
    for (const auto& [name, nodes] : mesh.node_groups) {
      if (!nameSays(name, word) || nodes.empty() || areCollinear(nodes, mesh)) continue;
      const auto on_surface = std::ranges::count_if(
          nodes, [&](std::int32_t node) { return std::ranges::binary_search(surface, node); });
      const auto share = static_cast<double>(on_surface) / static_cast<double>(surface.size());
      if (share <= most_fixed && name.find('"') == std::string::npos &&
          name.find('\\') == std::string::npos)
        return name;
    }
  return std::nullopt;
}

/// Returns the area, m^2, of the surface near one end of the axis: within the fraction `fixed_end`
/// of the body's extent.
double areaAtEnd(const Mesh& mesh, int axis, bool below) {
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  const double depth = fixed_end * box.sizes()[axis];
  double area = 0;
  for (const auto& [a, b, c] : mesh.surface) {
    const Eigen::Vector3d middle = (mesh.nodes[a] + mesh.nodes[b] + mesh.nodes[c]) / 3;
    const double from_end = below ? middle[axis] - box.min()[axis] : box.max()[axis] - middle[axis];
    if (from_end < depth)
      area += (mesh.nodes[b] - mesh.nodes[a]).cross(mesh.nodes[c] - mesh.nodes[a]).norm() / 2;
  }
  return area;
}

FixedProposal proposedFixed(const Mesh& mesh) {
  if (const auto group = fixedGroup(mesh))
    return {fmt::format("group = \"{}\"", *group),
            fmt::format("the group \"{}\", chosen by its name", *group)};
  int axis = 0;
  boundingBox(mesh).sizes().maxCoeff(&axis);
  const char word = "xyz"[axis];
  // If both ends are nearly equal, the lower one is taken.
  const bool below = areaAtEnd(mesh, axis, true) >= 0.98 * areaAtEnd(mesh, axis, false);
  return {fmt::format("{} = {{ axis = \"{}\", fraction = {} }}", below ? "below" : "above", word,
                      fixed_end),
          fmt::format("the {} {:.0f} % along {}, the broader end of the longest axis",
                      below ? "first" : "last", 100 * fixed_end, word)};
}

struct SurfaceMeasure {
  double area = 0;       ///< m^2
  double mean_edge = 0;  ///< m
};

SurfaceMeasure measuredSurface(const Mesh& mesh) {
  SurfaceMeasure measured;
  for (const Triangle& t : mesh.surface) {
    const Eigen::Vector3d u = mesh.nodes[t[1]] - mesh.nodes[t[0]],
                          v = mesh.nodes[t[2]] - mesh.nodes[t[0]];
    measured.area += u.cross(v).norm() / 2;
    measured.mean_edge += (u.norm() + v.norm() + (v - u).norm()) / 3;
  }
  measured.mean_edge /= static_cast<double>(mesh.surface.size());
  return measured;
}

/// Returns whether a finger of this radius, metres, would touch both sides of the body at more than
/// a tenth of the sites of `problem`. That would cause a warning as well.
bool reachesAround(const Problem& problem, double radius) {
  const auto both_sides = std::ranges::count_if(problem.active, [&](const ActivePatch& patch) {
    return patch.finger && isOnBothSides(problem.mesh, {patch.finger->center, radius});
  });
  return 10 * both_sides > std::ssize(problem.active);
}

/// Returns the number of warnings that every scene of this mesh causes.
std::size_t warningsOfMesh(const Mesh& mesh) {
  const MeshQuality quality = measure(mesh);
  return unjoinedText(mesh, quality, "").size() + (quality.nearly_flat > 0 ? 1 : 0);
}

/// Returns whether a finger of this radius, metres, may be better than the finger of `problem`,
/// which causes this number of avoidable warnings. Does not compute the sites of the new finger,
/// because that takes seconds on a thin body.
bool mayBeBetter(double radius, const Problem& problem, std::size_t warnings) {
  const double smaller = problem.scene.active.front().radius / radius;
  const auto places = static_cast<double>(problem.active.size()) * smaller * smaller;
  return (smaller < 1 || places <= most_places) &&
         (warnings > 1 || !reachesAround(problem, radius));
}

/// Rounds to two digits, which suffice for a proposal.
double rounded(double value) {
  const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
  return std::round(value / unit) * unit;
}

/// Returns the spaces between a number and the column in which comments begin.
std::string pad(double number, std::size_t longer_key = 0) {
  const std::size_t written =
      std::string("radius = ").size() + longer_key + fmt::format("{:.4g}", number).size();
  return std::string(written < 37 ? 37 - written : 1, ' ');
}

void describeParts(const Mesh& mesh, std::string& text) {
  if (mesh.element_groups.size() < 2) return;
  text +=
      "# The mesh names parts of the body. Each may have its own material; [material] is then for "
      "the rest.\n";
  for (const auto& [group, elements] : mesh.element_groups)
    text += fmt::format("# [[region]] group = \"{}\"  ({} of {} tetrahedra)\n", group,
                        elements.size(), mesh.tetrahedra.size());
}

/// Returns the text of the scene. `radius` of the finger and `depth` of the workspace are in the
/// unit of the file.
std::string sceneText(const Mesh& mesh, const std::string& name, const std::string& mesh_file,
                      const GuessedUnit& guess, double radius, double depth,
                      const FixedProposal& fixed) {
  const LengthUnit& unit = guess.unit;
  const Eigen::Vector3d size = boundingBox(mesh).sizes() / unit.metres;
  std::string text;
  const auto out = std::back_inserter(text);
  fmt::format_to(
      out,
      R"(# A scene for palpate, proposed from the mesh. Check the lines marked with <-. `palpate check` prints
# a summary of it and the cost of a build. docs/scene.md explains every key.
name = "{}"
mesh = "{}"
length_unit = "{}"{}# of the mesh and of all lengths here: the body is {:.3g} x {:.3g} x {:.3g} {}{}
)",
      name, mesh_file, unit.word, std::string(21 - unit.word.size(), ' '), size[0], size[1],
      size[2], unit.word,
      guess.doubt.empty()
          ? ""
          : fmt::format("\n#                                    <- check this: {}", guess.doubt));
  fmt::format_to(out, R"(
[material]                           # <- soft tissue: a liver after Peterlik et al., Computers & Graphics 34 (2010)
law = "mooney-rivlin"
c10 = {:.1f}                         # Pa; Young's modulus at small strains is 6 (c10 + c01), {:.0f} kPa
c01 = {:.1f}                         # Pa
)",
                 c10, tissue_young / 1000, c01);
  describeParts(mesh, text);
  fmt::format_to(out, R"(
[fixed]                              # <- the nodes that hold the body: {}
{}

[[active]]                           # the tool: a soft finger, anywhere on the surface that is not fixed
name = "skin"
surface = "all"                      # or {{ box = ... }}, {{ sphere = ... }}, {{ group = ... }}
tool = "finger"
radius = {:.4g}{}# {}: radius of the contact area of the finger; at least one edge of the mesh, better two

[workspace]                          # how far the finger pushes, and how finely that is computed
radius = {:.4g}{}# {}: largest displacement; thick parts reach the largest force of the device earlier
spacing = {:.4g}{}# {}: spacing of the coarsest lattice of displacements
)",
                 fixed.why, fixed.toml, radius, pad(radius), unit.word, depth, pad(depth),
                 unit.word, depth / 2, pad(depth / 2, 1), unit.word);
  fmt::format_to(out, R"(
[accuracy]
force_error = 0.05                   # relative error above which the lattice is refined; a hand feels differences of 7 %
force_floor = 0.01                   # N: a smaller error is always allowed
levels = 1                           # number of times a cell may be halved; force_error = 0.03 with levels = 2 is better, but slower
probes = 100                         # exact solutions at random places, from which `palpate report` measures errors

[device]
profile = "{}"                    # <- the haptic device; solving does not go on from a point beyond its limit, {} N

[storage]
precision = "int16"                  # displacements, which only the display uses, take half the space
)",
                 proposed_device.name, proposed_device.max_force);
  return text;
}

}  // namespace

ProposedScene proposedScene(const Mesh& mesh, const std::string& name, const std::string& mesh_file,
                            const GuessedUnit& guess) {
  const LengthUnit& unit = guess.unit;
  const SurfaceMeasure measured = measuredSurface(mesh);
  const FixedProposal fixed = proposedFixed(mesh);
  const double wanted =
      std::max(wanted_edges * measured.mean_edge, std::sqrt(measured.area / area_per_finger));
  const std::size_t unavoidable = warningsOfMesh(mesh);
  std::optional<ProposedScene> best;
  Problem problem;  // of `best`
  std::optional<Error> refusal;
  for (const double share : finger_shares) {
    const double radius = rounded(share * wanted / unit.metres);
    const double radius_m = radius * unit.metres;
    if (best && !mayBeBetter(radius_m, problem, best->warnings.size() - unavoidable)) continue;
    if (best) spdlog::info("trying another finger of radius {:.4g} {}", radius, unit.word);
    const double depth =
        rounded(std::min(deepest * radius_m,
                         force_depth * proposed_device.max_force / (tissue_young * radius_m)) /
                unit.metres);
    ProposedScene scene{sceneText(mesh, name, mesh_file, guess, radius, depth, fixed), {}};
    scene.choices = {fmt::format("fixed      {}", fixed.why),
                     fmt::format("finger     radius {:.4g} {}: {:.2g} edges of the surface", radius,
                                 unit.word, radius_m / measured.mean_edge),
                     fmt::format("workspace  {:.4g} {} deep", depth, unit.word)};
    Problem tried;
    try {
      tried = resolve(parseScene(scene.toml, "the proposed scene"), mesh);
      scene.warnings = warningsOf(tried);
    } catch (const Error& error) {
      // Another finger may be accepted. But if two fingers cause the same error, the error does not
      // depend on the size of the finger.
      const bool told = !best && refusal && std::string_view(error.what()) == refusal->what();
      if (told || error.exitCode() != ExitCode::usage) throw;
      if (!refusal) refusal = error;
      continue;
    }
    if (!best || scene.warnings.size() < best->warnings.size()) {
      best = std::move(scene);
      problem = std::move(tried);
    }
    if (best->warnings.size() <= unavoidable) break;
  }
  if (!best) throw *refusal;
  return std::move(*best);
}

void refuseMeshName(const std::filesystem::path& file, const char* option) {
  const std::string name = file.filename().string();
  const bool fits = std::ranges::none_of(name, [](const char c) {
    return static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '"' || c == '\\';
  });
  if (!fits)
    throw badInput("{} {}: a scene cannot name this file; rename it with letters, digits, - and _",
                   option, printable(name, longest_reason));
}

}  // namespace palpate
