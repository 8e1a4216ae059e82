#include "worker/check_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "common/problem/problem.hpp"
#include "common/scene/material_toml.hpp"
#include "common/space/lattice.hpp"

namespace palpate {
namespace {

/// Tetrahedra below this shape (1 regular, 0 flat) spoil the conditioning and invert first.
constexpr double near_flat_shape = 0.1;

/// Measured: one configuration of a lattice with 20 mm spacing, Mooney-Rivlin with P1-stabilized
/// pressure, one core at 2.6 GHz, takes 14 ms at 493 nodes and 150 ms at 2228. A power law between
/// the two; beyond them an extrapolation.
double secondsPerConfiguration(std::size_t n_nodes) {
  constexpr double nodes_a = 493, seconds_a = 0.014, nodes_b = 2228, seconds_b = 0.150;
  const double exponent = std::log(seconds_b / seconds_a) / std::log(nodes_b / nodes_a);
  return seconds_a * std::pow(static_cast<double>(n_nodes) / nodes_a, exponent);
}

/// Cubes of one spacing between lattice points that reach into the ball.
double cellsOfBall(const Lattice& lattice) {
  const double ratio = lattice.radius() / lattice.spacing();
  const int extent = static_cast<int>(std::ceil(ratio));
  const auto nearest = [](int lowest) { return lowest >= 0 ? lowest : -(lowest + 1); };
  std::int64_t count = 0;
  for (int i = -extent; i < extent; ++i)
    for (int j = -extent; j < extent; ++j)
      for (int k = -extent; k < extent; ++k) {
        const double x = nearest(i), y = nearest(j), z = nearest(k);
        count += x * x + y * y + z * z < ratio * ratio;
      }
  return static_cast<double>(count);
}

/// At most so many names are listed.
constexpr std::size_t listed_names = 5;

/// `"a", "b" and 398 more`.
std::string listOf(const std::vector<std::string>& names) {
  const std::size_t shown = names.size() <= listed_names + 1 ? names.size() : listed_names;
  std::string text = fmt::format(
      "\"{}\"",
      fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), "\", \""));
  if (shown < names.size()) text += fmt::format(" and {} more", names.size() - shown);
  return text;
}

/// One configuration space, as far as it is known without solving.
struct Space {
  const ActivePatch* patch;
  std::size_t unknowns;  ///< displacement components and pressures to solve for
};

/// What a build of so many configurations amounts to.
struct Estimate {
  double configurations = 0;  ///< probes too
  double seconds = 0;         ///< on one core
  double bytes = 0;           ///< of nodal fields, before compression
};

/// What there is to say of a problem.
struct Report {
  explicit Report(const Problem& given)
      : problem(given), quality(measure(given.mesh)), lattice(uniformLattice(given.scene)) {
    const std::size_t n_nodes = problem.mesh.nodes.size(), n_pressures = pressureNodes(problem);
    for (const ActivePatch& patch : problem.active) {
      const std::size_t moved = patch.weights.empty() ? patch.nodes.size() : 0;
      spaces.push_back({&patch, 3 * (n_nodes - problem.fixed.size() - moved) + n_pressures});
    }
    tetrahedra_in.resize(problem.scene.regions.size());
    for (const std::uint16_t region : problem.region_of) ++tetrahedra_in[region];
    for (std::size_t e = 0; e < problem.mesh.tetrahedra.size(); ++e)
      near_flat += shapeOf(problem.mesh, e) < near_flat_shape;
    const Accuracy& accuracy = problem.scene.accuracy;
    const auto n_spaces = static_cast<std::int64_t>(spaces.size());
    probes = n_spaces * accuracy.probes;
    points = n_spaces * lattice.size();
    most_points = static_cast<double>(points);
    if (accuracy.adaptive())
      most_points +=
          static_cast<double>(n_spaces) * cellsOfBall(lattice) * std::pow(8, accuracy.levels);
    seconds_each = secondsPerConfiguration(n_nodes);
    const Storage& storage = problem.scene.storage;
    const bool all = storage.displacement == StoredNodes::all;
    const std::size_t component_bytes = storage.precision == StoredPrecision::int16 ? 2 : 4;
    const std::size_t n_stored = all ? n_nodes : surfaceNodes(problem.mesh).size();
    bytes_each = static_cast<double>(3 * component_bytes * n_stored + (all ? 4 * n_pressures : 0));
    findWarnings();
  }

  Estimate estimateOf(double n_points) const {
    const double configurations = n_points + static_cast<double>(probes);
    return {configurations, configurations * seconds_each, n_points * bytes_each};
  }
  Estimate least() const { return estimateOf(static_cast<double>(points)); }
  Estimate most() const { return estimateOf(most_points); }

  void findWarnings() {
    const Workspace& workspace = problem.scene.workspace;
    if (const std::string warning = infSupWarning(problem.scene.discretization); !warning.empty())
      warnings.push_back(warning);
    if (near_flat > 0)
      warnings.push_back(
          fmt::format("{} of {} tetrahedra are nearly flat (shape < {}, "
                      "the worst is element {} with {:.3g}): they invert first; "
                      "re-mesh or optimise (gmsh -optimize_netgen)",
                      near_flat, problem.mesh.tetrahedra.size(), near_flat_shape,
                      quality.worst_element, quality.worst_shape));
    if (workspace.radius > (quality.highest - quality.lowest).norm())
      warnings.push_back(
          fmt::format("workspace.radius = {:.4g} m is more than the body's diagonal of {:.4g} m: "
                      "few of those configurations will be reached",
                      workspace.radius, (quality.highest - quality.lowest).norm()));
    findSingleNodeWarnings();
    findTwinWarning();
  }

  void findSingleNodeWarnings() {
    std::vector<std::string> single, lonely;
    for (std::size_t i = 0; i < spaces.size(); ++i) {
      const ActivePatch& patch = *spaces[i].patch;
      const double radius = problem.scene.active[i].radius;
      if (radius == 0) single.push_back(patch.name);
      if (radius > 0 && patch.nodes.size() == 1) lonely.push_back(patch.name);
    }
    if (!single.empty())
      warnings.push_back(
          fmt::format("active {}: a single node (radius = 0), "
                      "whose force has no limit as the mesh gets finer, so it depends on the mesh; "
                      "give the radius of the contact",
                      listOf(single)));
    if (!lonely.empty())
      warnings.push_back(fmt::format(
          "active {}: no other node lies within the radius (edges are {:.4g} m on average), "
          "so it is a single node and its force depends on the mesh",
          listOf(lonely), quality.mean_edge));
  }

  void findTwinWarning() {
    std::map<std::int32_t, std::string> name_of;
    std::vector<std::string> twins;
    for (const Space& space : spaces) {
      const auto [first, is_new] = name_of.emplace(space.patch->node, space.patch->name);
      if (!is_new) twins.push_back(fmt::format("{}\" and \"{}", first->second, space.patch->name));
    }
    if (!twins.empty())
      warnings.push_back(fmt::format("active {}: are the same node", listOf(twins)));
  }

  const Problem& problem;
  MeshQuality quality;
  Lattice lattice;
  std::vector<Space> spaces;
  std::vector<std::int64_t> tetrahedra_in;  ///< per region
  std::int64_t near_flat = 0;
  std::int64_t points = 0;  ///< of all lattices; of an adaptive build the least
  double most_points = 0;   ///< when every cell is halved as often as it may be
  std::int64_t probes = 0;
  double seconds_each = 0, bytes_each = 0;
  std::vector<std::string> warnings;
};

std::string duration(double seconds) {
  if (seconds < 100) return fmt::format("{:.2g} s", seconds);
  if (seconds < 100 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string text(const Eigen::Vector3d& v) {
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", v[0], v[1], v[2]);
}

std::string_view toolOf(const Space& space) {
  return word(space.patch->weights.empty() ? ToolKind::rigid : ToolKind::weighted_average);
}

void printMesh(const Report& report) {
  const Mesh& mesh = report.problem.mesh;
  const MeshQuality& quality = report.quality;
  const std::string middles =
      mesh.edges.empty() ? "" : fmt::format(" and {} mid-edge nodes", mesh.edges.size());
  fmt::print(
      "mesh       {}: {} nodes{}, {} tetrahedra, {} surface triangles with {} nodes, {} piece(s)\n",
      report.problem.scene.mesh.filename().string(), mesh.vertices(), middles,
      mesh.tetrahedra.size(), mesh.surface.size(), surfaceNodes(mesh).size(), quality.pieces);
  fmt::print("           from {} to {} m, {:.4g} litres\n", text(quality.lowest),
             text(quality.highest), 1000 * quality.volume);
  fmt::print(
      "           edges {:.4g} to {:.4g} m, mean {:.4g}; shape (1 regular, 0 flat) mean {:.3g}, "
      "worst {:.3g} in element {}\n",
      quality.shortest_edge, quality.longest_edge, quality.mean_edge, quality.mean_shape,
      quality.worst_shape, quality.worst_element);
  if (mesh.dropped_nodes > 0)
    fmt::print(
        "           note: {} node(s) that are no corner of a tetrahedron were dropped, "
        "later ones count down\n",
        mesh.dropped_nodes);
  if (mesh.reoriented_tetrahedra > 0)
    fmt::print("           note: the file counts its tetrahedra left-handed; all were turned\n");
  for (const auto& [name, nodes] : mesh.node_groups)
    fmt::print("group      \"{}\": {} nodes\n", name, nodes.size());
  for (const auto& [name, elements] : mesh.element_groups)
    fmt::print("group      \"{}\": {} tetrahedra\n", name, elements.size());
}

/// The scene's lengths in metres, for the one who wrote them in another unit.
void printConversion(const Scene& scene) {
  if (scene.metres_per_unit == 1) return;
  fmt::print(
      "unit       1 in the files = {} m; in metres: workspace.radius = {:.6g}, "
      "workspace.spacing = {:.6g}\n",
      scene.metres_per_unit, scene.workspace.radius, scene.workspace.spacing);
  for (const ActiveSelection& active :
       std::span(scene.active).first(std::min(scene.active.size(), listed_names))) {
    const std::string near = active.near ? fmt::format("near = {}, ", text(*active.near)) : "";
    fmt::print("           active \"{}\": {}radius = {:.6g}\n", active.name, near, active.radius);
  }
}

void printBody(const Report& report) {
  const Scene& scene = report.problem.scene;
  for (std::size_t r = 0; r < scene.regions.size(); ++r) {
    const auto& [group, material] = scene.regions[r];
    if (scene.regions.size() == 1 && group.empty())
      fmt::print("material   {}\n", inWords(material));
    else
      fmt::print("material   {} ({} tetrahedra): {}\n",
                 group.empty() ? "rest" : fmt::format("\"{}\"", group), report.tetrahedra_in[r],
                 inWords(material));
  }
  const Discretization& d = scene.discretization;
  fmt::print("solved as  displacement {}, pressure {}", word(d.displacement), word(d.pressure));
  if (d.pressure != PressureSpace::none) fmt::print(", constraint {}", word(d.constraint));
  fmt::print("\n");
  if (!scene.gravity.isZero(0)) fmt::print("gravity    {} m/s^2\n", text(scene.gravity));
}

void printActives(const Report& report) {
  const std::size_t n_spaces = report.spaces.size();
  const std::size_t shown = n_spaces <= 2 * listed_names ? n_spaces : listed_names;
  for (const Space& space : std::span(report.spaces).first(shown))
    fmt::print("active     \"{}\": node {} at {} m, {} patch of {} node(s), {} unknowns\n",
               space.patch->name, space.patch->node,
               text(report.problem.mesh.nodes[space.patch->node]), toolOf(space),
               space.patch->nodes.size(), space.unknowns);
  if (shown < n_spaces)
    fmt::print("           and {} more, \"{}\" the last: {} active nodes\n", n_spaces - shown,
               report.spaces.back().patch->name, n_spaces);
}

void printDevice(const Scene& scene) {
  if (!scene.device) return;
  const DeviceProfile& profile = scene.device->profile;
  fmt::print("device     {}: reaches {:.4g} m, {:.4g} N, {:.4g} N/m\n", profile.name,
             profile.workspace_radius, profile.max_force, profile.max_stiffness);
  if (const auto radius = scene.device->wanted_radius)
    fmt::print("           workspace.radius cut from {:.4g} to {:.4g} m\n", *radius,
               scene.workspace.radius);
  if (const auto force = scene.device->wanted_max_force)
    fmt::print("           workspace.max_force cut from {:.4g} to {:.4g} N\n", *force,
               scene.workspace.max_force);
}

void printAccuracy(const Accuracy& accuracy) {
  if (accuracy.adaptive())
    fmt::print("accuracy   force to {:.3g} % or {:.3g} N: cells are halved up to {} times\n",
               100 * accuracy.force_error, accuracy.force_floor, accuracy.levels);
  if (accuracy.probes > 0) fmt::print("probes     {} in each space\n", accuracy.probes);
}

void printCost(const Report& report) {
  const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
  const double seconds = report.least().seconds, megabytes = report.least().bytes / 1e6;
  if (!report.problem.scene.accuracy.adaptive()) {
    fmt::print("cost       about {} on one core, {} on the {} of this machine; dataset {:.3g} MB\n",
               duration(seconds), duration(seconds / cores), cores, megabytes);
    return;
  }
  const double most_seconds = report.most().seconds, most_megabytes = report.most().bytes / 1e6;
  fmt::print(
      "cost       an estimate, since cells are split where the forces turn out to need it: "
      "between {} (no cell is split) and {} (all are, to the last level) on one core, "
      "{} and {} on the {} of this machine; dataset {:.3g} to {:.3g} MB\n",
      duration(seconds), duration(most_seconds), duration(seconds / cores),
      duration(most_seconds / cores), cores, megabytes, most_megabytes);
}

void printText(const Report& report) {
  const Scene& scene = report.problem.scene;
  fmt::print("scene      {}\n", scene.name);
  printMesh(report);
  printConversion(scene);
  printBody(report);
  fmt::print("fixed      {} nodes\n", report.problem.fixed.size());
  printActives(report);
  printDevice(scene);
  fmt::print(
      "lattice    radius {:.4g} m, spacing {:.4g} m: {} points in each of {} space(s), "
      "{}{} configurations\n",
      report.lattice.radius(), report.lattice.spacing(), report.lattice.size(),
      report.spaces.size(), scene.accuracy.adaptive() ? "at least " : "",
      report.least().configurations);
  printAccuracy(scene.accuracy);
  printCost(report);
  for (const std::string& warning : report.warnings) fmt::print("warning    {}\n", warning);
}

nlohmann::ordered_json vectorJson(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

nlohmann::ordered_json meshJson(const Report& report) {
  const Mesh& mesh = report.problem.mesh;
  const MeshQuality& quality = report.quality;
  nlohmann::ordered_json groups = nlohmann::ordered_json::object();
  for (const auto& [name, nodes] : mesh.node_groups) groups[name] = nodes.size();
  return {{"file", report.problem.scene.mesh.string()},
          {"nodes", mesh.vertices()},
          {"mid_edge_nodes", mesh.edges.size()},
          {"tetrahedra", mesh.tetrahedra.size()},
          {"surface_triangles", mesh.surface.size()},
          {"surface_nodes", surfaceNodes(mesh).size()},
          {"pieces", quality.pieces},
          {"groups", groups},
          {"dropped_nodes", mesh.dropped_nodes},
          {"reoriented_tetrahedra", mesh.reoriented_tetrahedra},
          {"lowest", vectorJson(quality.lowest)},
          {"highest", vectorJson(quality.highest)},
          {"volume", quality.volume},
          {"edge",
           {{"shortest", quality.shortest_edge},
            {"mean", quality.mean_edge},
            {"longest", quality.longest_edge}}},
          {"shape",
           {{"worst", quality.worst_shape},
            {"mean", quality.mean_shape},
            {"worst_element", quality.worst_element}}},
          {"nearly_flat", report.near_flat}};
}

nlohmann::ordered_json deviceJson(const Scene& scene) {
  if (!scene.device) return nullptr;
  const Device& device = *scene.device;
  const auto orNull = [](const std::optional<double>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
  };
  return {{"profile", device.profile.name},
          {"max_force", device.profile.max_force},
          {"max_stiffness", device.profile.max_stiffness},
          {"workspace_radius", device.profile.workspace_radius},
          {"radius_cut_from", orNull(device.wanted_radius)},
          {"max_force_cut_from", orNull(device.wanted_max_force)}};
}

nlohmann::ordered_json toJson(const Report& report) {
  const Scene& scene = report.problem.scene;
  nlohmann::ordered_json active = nlohmann::ordered_json::array();
  for (const Space& space : report.spaces)
    active.push_back({{"name", space.patch->name},
                      {"node", space.patch->node},
                      {"position", vectorJson(report.problem.mesh.nodes[space.patch->node])},
                      {"tool", toolOf(space)},
                      {"patch_nodes", space.patch->nodes.size()},
                      {"unknowns", space.unknowns}});
  nlohmann::ordered_json regions = nlohmann::ordered_json::array();
  for (std::size_t r = 0; r < scene.regions.size(); ++r)
    regions.push_back({{"group", scene.regions[r].group},
                       {"law", word(scene.regions[r].material.law)},
                       {"tetrahedra", report.tetrahedra_in[r]}});
  const Estimate least = report.least(), most = report.most();
  return {{"scene", scene.name},
          {"problem", problemId(report.problem).hex()},
          {"metres_per_unit", scene.metres_per_unit},
          {"mesh", meshJson(report)},
          {"regions", regions},
          {"gravity", vectorJson(scene.gravity)},
          {"displacement", word(scene.discretization.displacement)},
          {"pressure", word(scene.discretization.pressure)},
          {"constraint", word(scene.discretization.constraint)},
          {"fixed_nodes", report.problem.fixed.size()},
          {"active", active},
          {"lattice",
           {{"radius", report.lattice.radius()},
            {"spacing", report.lattice.spacing()},
            {"points", report.lattice.size()}}},
          {"device", deviceJson(scene)},
          {"adaptive", scene.accuracy.adaptive()},
          {"configurations", least.configurations},
          {"core_seconds", least.seconds},
          {"dataset_bytes", least.bytes},
          {"most_configurations", most.configurations},
          {"most_core_seconds", most.seconds},
          {"most_dataset_bytes", most.bytes},
          {"warnings", report.warnings}};
}

struct CheckOptions {
  std::string scene;
  bool json = false;
};

ExitCode check(const CheckOptions& options) {
  const Problem problem = loadProblem(options.scene);
  const Report report(problem);
  if (options.json)
    fmt::print("{}\n", toJson(report).dump());
  else
    printText(report);
  return ExitCode::done;
}

std::function<ExitCode()> prepare(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  app.add_option("SCENE", options->scene, "The scene, a TOML file (docs/scene.md)")
      ->required()
      ->type_name("FILE");
  app.add_flag("--json", options->json, "One JSON object, lengths in metres");
  return [options] { return check(*options); };
}

}  // namespace

const Verb check_verb = {
    "check", "Validate a scene; print sizes, mesh quality and cost; compute nothing", prepare};

}  // namespace palpate
