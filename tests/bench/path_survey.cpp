// The paper's stability test: paths of 100 mm in 26 directions from ten active nodes, the body held
// in two ways.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/mesh/mesh_reader.hpp"
#include "common/problem/problem.hpp"
#include "tests/support/problems.hpp"
#include "worker/solver/path.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::filesystem::path mesh;
  std::string law = "mooney-rivlin";
  std::string constraint = "ln-det-F";
  std::string tool = "rigid";
  double radius = 0;
  double length = 0.1;
  double transition = 0.02;
  int nodes = 10;
  int budget = TransitionOptions{}.max_factorizations;
  bool every_path = false;
};

Scene sceneOf(const Options& options) {
  Scene scene = test::mooneyRivlinScene();
  if (options.law == "modified-st-venant-kirchhoff") {
    scene = test::youngScene(LawName::modified_st_venant_kirchhoff);
    scene.regions[0].material.poisson.reset();
  } else if (options.law == "st-venant-kirchhoff") {
    scene = test::youngScene(LawName::st_venant_kirchhoff, 0.49);
  }
  scene.discretization.constraint =
      options.constraint == "ln-det-F" ? Constraint::ln_det_F : Constraint::det_F_minus_1;
  return scene;
}

/// Surface nodes far from what is held and from each other: each the farthest from all before.
std::vector<std::int32_t> spreadNodes(const Mesh& mesh, const std::vector<std::int32_t>& fixed,
                                      int count) {
  constexpr double clearance = 0.03;
  std::vector<std::int32_t> candidates;
  std::vector<double> distance;
  for (const std::int32_t node : surfaceNodes(mesh)) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::int32_t held : fixed)
      nearest = std::min(nearest, (mesh.nodes[node] - mesh.nodes[held]).norm());
    if (nearest < clearance) continue;
    candidates.push_back(node);
    distance.push_back(nearest);
  }
  std::vector<std::int32_t> chosen;
  while (static_cast<int>(chosen.size()) < count) {
    const auto farthest = std::max_element(distance.begin(), distance.end()) - distance.begin();
    chosen.push_back(candidates[farthest]);
    for (std::size_t n = 0; n < candidates.size(); ++n)
      distance[n] =
          std::min(distance[n], (mesh.nodes[candidates[n]] - mesh.nodes[chosen.back()]).norm());
  }
  return chosen;
}

Problem problemOf(const Options& options, int axis) {
  Scene scene = sceneOf(options);
  scene.fixed = {};
  scene.fixed.half_spaces = {{axis, true, 0.15, std::nullopt}};
  ActiveSelection active;
  active.name = "any";
  active.near = Eigen::Vector3d::Zero();
  scene.active = {active};
  Mesh mesh = readGmsh(options.mesh);
  // Once for the fixed nodes, of which the active ones keep clear.
  Scene first = scene;
  first.active[0].near = mesh.nodes[surfaceNodes(mesh).back()];
  const auto highest =
      std::max_element(mesh.nodes.begin(), mesh.nodes.end(),
                       [&](const auto& a, const auto& b) { return a[axis] < b[axis]; });
  first.active[0].near = *highest;
  const Problem held = resolve(first, mesh);
  scene.active.clear();
  for (const std::int32_t node : spreadNodes(held.mesh, held.fixed, options.nodes)) {
    active.near.reset();
    active.node = node;
    active.name = fmt::format("node-{}", node);
    active.radius = options.radius;
    active.tool = options.tool == "rigid" ? ToolKind::rigid : ToolKind::weighted_average;
    scene.active.push_back(active);
  }
  return resolve(std::move(scene), std::move(mesh));
}

struct Path {
  std::string node;
  Eigen::Vector3i direction;
  WalkedPath walked;
};

std::vector<Eigen::Vector3i> directions() {
  std::vector<Eigen::Vector3i> all;
  for (int i = -1; i <= 1; ++i)
    for (int j = -1; j <= 1; ++j)
      for (int k = -1; k <= 1; ++k)
        if (i != 0 || j != 0 || k != 0) all.emplace_back(i, j, k);
  return all;
}

Json toJson(const Path& path, double length) {
  const Outcome& outcome = path.walked.outcome;
  Json json = {{"active", path.node},
               {"direction", {path.direction[0], path.direction[1], path.direction[2]}},
               {"reached_m", length * (outcome.converged ? 1 : outcome.failure.step_reached)},
               {"smallest_det_F", path.walked.min_det_F},
               {"detours", path.walked.detours},
               {"factorizations", outcome.cost.factorizations},
               {"newton_iterations", outcome.cost.newton_iterations},
               {"seconds", outcome.cost.seconds}};
  if (!outcome.converged) {
    json["cause"] = name(outcome.failure.cause);
    json["element"] = outcome.failure.element;
    json["element_det_F"] = outcome.failure.element_det_F;
    json["negative_pivots"] = outcome.failure.negative_pivots;
    json["expected_negative_pivots"] = outcome.failure.expected_negative_pivots;
    json["residual"] = outcome.failure.residual;
  }
  return json;
}

Json survey(const Options& options) {
  int paths = 0, straight = 0, complete = 0, factorizations = 0;
  const int transitions = static_cast<int>(std::round(options.length / options.transition));
  double seconds = 0;
  std::map<std::string, int> causes;
  Json stopped = Json::array(), every = Json::array();
  for (const int axis : {0, 1}) {
    const Problem problem = problemOf(options, axis);
    TransitionOptions transition;
    transition.max_factorizations = options.budget;
    TransitionSolver solver(problem, chooseKernels(), transition);
    for (std::size_t space = 0; space < problem.active.size(); ++space) {
      solver.chooseTool(space);
      Failure failure;
      const auto rest = solver.startAtRest(failure);
      if (!rest) throw palpate::failure("rest: {}", describe(failure));
      for (const Eigen::Vector3i& direction : directions()) {
        const Eigen::Vector3d target = options.length * direction.cast<double>().normalized();
        const Path path = {fmt::format("{}/{}", axis == 0 ? "x" : "y", problem.active[space].name),
                           direction, walk(solver, *rest, target, transitions)};
        const Outcome& outcome = path.walked.outcome;
        ++paths;
        seconds += outcome.cost.seconds;
        factorizations += outcome.cost.factorizations;
        complete += outcome.converged ? 1 : 0;
        straight += outcome.converged && path.walked.detours == 0 ? 1 : 0;
        if (options.every_path) every.push_back(toJson(path, options.length));
        if (outcome.converged) continue;
        ++causes[std::string(name(outcome.failure.cause))];
        stopped.push_back(toJson(path, options.length));
      }
    }
  }
  Json result = {{"benchmark", "path_survey"},
                 {"mesh", options.mesh.filename().string()},
                 {"law", options.law},
                 {"constraint", options.constraint},
                 {"tool", options.tool},
                 {"radius_m", options.radius},
                 {"paths", paths},
                 {"complete", complete},
                 {"complete_without_detours", straight},
                 {"percent", 100.0 * complete / paths},
                 {"causes", causes},
                 {"factorizations_per_transition", factorizations / (1.0 * paths * transitions)},
                 {"seconds", seconds},
                 {"stopped", stopped}};
  if (options.every_path) result["every_path"] = every;
  return result;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
  palpate::Options options;
  CLI::App app(
      "Paths of 100 mm in 26 directions, ten active nodes, two sets of fixed nodes; prints JSON");
  app.add_option("MESH", options.mesh, "A .msh file in metres")->required();
  app.add_option("--law", options.law)
      ->check(
          CLI::IsMember({"mooney-rivlin", "modified-st-venant-kirchhoff", "st-venant-kirchhoff"}));
  app.add_option("--constraint", options.constraint)->check(CLI::IsMember({"ln-det-F", "det-F-1"}));
  app.add_option("--tool", options.tool)->check(CLI::IsMember({"rigid", "weighted-average"}));
  app.add_option("--radius", options.radius, "Of the patch, m; 0: a single node");
  app.add_option("--transition", options.transition, "Distance between configurations, m");
  app.add_option("--nodes", options.nodes, "Active nodes");
  app.add_option("--budget", options.budget, "Factorisations a transition may take");
  app.add_flag("--every-path", options.every_path, "Print every path, not only those that stopped");
  CLI11_PARSE(app, argc, argv);
  fmt::print("{}\n", palpate::survey(options).dump(1));
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "palpate_path_survey: %s\n", error.what());
  return 1;
}
