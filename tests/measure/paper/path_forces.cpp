// Exact solutions along paths, each computed from the one before. tests/measure/paper compares
// interpolations, other laws and other elements with them.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/problem/problem.hpp"
#include "common/scene/active_choice.hpp"
#include "worker/solver/path.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, active;
  double transition = 0.02;
  bool detours = false;
};

Json toJson(const Eigen::Vector3d& v) { return {v[0], v[1], v[2]}; }

/// Volumes of the body, deformed and at rest, m^3: of tetrahedra whose nodes are moved by `u`.
/// Quadratic edges count as straight.
double volume(const Mesh& mesh, const std::vector<double>& u) {
  double sum = 0;
  for (const auto& corners : mesh.tetrahedra) {
    Eigen::Matrix<double, 3, 4> x;
    for (int c = 0; c < 4; ++c) {
      x.col(c) = mesh.nodes[corners[c]];
      if (!u.empty()) x.col(c) += Eigen::Map<const Eigen::Vector3d>(&u[3 * corners[c]]);
    }
    Eigen::Matrix3d edges = x.rightCols<3>();
    edges.colwise() -= x.col(0);
    sum += edges.determinant() / 6;
  }
  return sum;
}

Json toJson(const Outcome& outcome) {
  const Equilibrium& e = outcome.equilibrium();
  return {{"force", toJson(e.force)},
          {"energy", e.energy},
          {"min_det_F", e.min_det_F},
          {"newton_iterations", outcome.cost.newton_iterations},
          {"factorizations", outcome.cost.factorizations},
          {"seconds", outcome.cost.seconds}};
}

/// Walks from rest through `points` until one is not reached.
Json walkThrough(TransitionSolver& solver, const Start& rest, const Options& options,
                 const Mesh& mesh, const Json& points) {
  const double at_rest = volume(mesh, {});
  Json reached = Json::array(), path;
  Start at = rest;
  for (const Json& point : points) {
    const Eigen::Vector3d target(point.at(0).get<double>(), point.at(1).get<double>(),
                                 point.at(2).get<double>());
    const double distance = (target - at.state.displacement).norm();
    const int transitions =
        std::max(1, static_cast<int>(std::ceil(distance / options.transition - 1e-9)));
    Reached walked =
        walk(solver, at, target, transitions, options.detours ? Rescue::detours : Rescue::none);
    if (!walked.outcome.converged()) {
      const Failure& failure = walked.outcome.failure();
      path = {{"cause", name(failure.cause)},
              {"failure", describe(failure)},
              {"step_reached", failure.step_reached},
              {"failed_factorizations", walked.outcome.cost.factorizations},
              {"failed_seconds", walked.outcome.cost.seconds}};
      break;
    }
    at = std::move(*walked.end);
    Json one = toJson(walked.outcome);
    one["displacement"] = toJson(target);
    one["detours"] = walked.detours;
    one["smallest_det_F_on_the_way"] = walked.min_det_F;
    one["volume"] = volume(mesh, at.state.u) / at_rest;
    reached.push_back(std::move(one));
  }
  path["reached"] = std::move(reached);
  return path;
}

Json solveAll(const Options& options, const Json& paths) {
  const Problem problem = loadProblem(options.scene);
  TransitionSolver solver(problem, chooseKernels());
  solver.chooseTool(chooseActive(problem.scene, options.active).spaces.front());
  Failure failure;
  const auto rest = solver.startAtRest(failure);
  if (!rest) throw palpate::failure("rest: {}", describe(failure));
  Json solved = Json::array();
  for (const Json& points : paths)
    solved.push_back(walkThrough(solver, *rest, options, problem.mesh, points));
  return {{"benchmark", "path_forces"},
          {"transition_m", options.transition},
          {"kernels", chooseKernels().family},
          {"paths", std::move(solved)}};
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
  palpate::Options options;
  CLI::App app("Exact solutions along paths from rest; prints JSON");
  app.footer("stdin: [[[x, y, z], ...], ...], for each path the displacements it leads through, m");
  app.add_option("SCENE", options.scene, "A scene file")->required();
  app.add_option("--active", options.active, "Which, where there are several");
  app.add_option("--transition", options.transition, "Distance between configurations, m")
      ->check(CLI::PositiveNumber);
  app.add_flag("--detours", options.detours, "By way of points beside, where straight on fails");
  CLI11_PARSE(app, argc, argv);
  fmt::print("{}\n", palpate::solveAll(options, palpate::Json::parse(std::cin)).dump());
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "palpate_path_forces: %s\n", error.what());
  return 1;
}
