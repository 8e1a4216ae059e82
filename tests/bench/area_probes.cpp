// How wrong the energy of a finger's area is between its sites: exact solutions at random places
// and displacements against the dataset, and beside it what the nearest site alone says, which is
// the paper's way. Prints one JSON object.
//
// Places are uniform over the surface that the sites answer for, displacements over what of the
// ball presses within `cone` of the inward normal. Those whose exact force is beyond the scene's
// max_force, or that have no solution by continuation from rest, are counted apart.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <random>

#include "common/base/error.hpp"
#include "common/dataset/dataset.hpp"
#include "common/mesh/surface_pieces.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/finger.hpp"
#include "common/problem/sites.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/fields/potential_field.hpp"
#include "worker/solver/transition.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
  std::string scene, dataset, area;
  int probes = 1000;
  unsigned seed = 1;
  double cone = 60;  ///< degrees
};

struct Probe {
  Eigen::Vector3d place, displacement;
};

/// Uniform over the surface, and over the cone of each place.
class Drawing {
 public:
  Drawing(const Mesh& mesh, double radius, double reach, double cone, unsigned seed)
      : random_(seed), reach_(reach), cosine_(std::cos(cone * M_PI / 180)) {
    double area = 0;
    for (std::int32_t t = 0; t < std::ssize(mesh.surface); ++t)
      forEachPiece(mesh, t, place_distance * radius, [&](const SurfacePiece& piece) {
        places_.push_back({piece.middle, normalOf(mesh, t)});
        areas_.push_back(area += piece.area);
      });
  }
  Probe draw() {
    const auto n = std::ranges::lower_bound(areas_, number(0, areas_.back())) - areas_.begin();
    const auto& [place, normal] = places_[static_cast<std::size_t>(n)];
    for (;;) {
      const Eigen::Vector3d p(number(-1, 1), number(-1, 1), number(-1, 1));
      if (p.norm() <= 1 && p.dot(normal) <= -cosine_ * p.norm()) return {place, reach_ * p};
    }
  }

 private:
  double number(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  std::mt19937 random_;
  double reach_, cosine_;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> places_;
  std::vector<double> areas_;
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::ranges::sort(values);
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Errors of one way of answering.
struct Errors {
  std::vector<double> relative;
  int kept = 0;
  void record(const Eigen::Vector3d& found, const Eigen::Vector3d& exact, const Accuracy& wanted) {
    const double error = (found - exact).norm();
    relative.push_back(error / exact.norm());
    const double share = wanted.adaptive() ? wanted.force_error : 0.03;
    kept += error <= std::max(share * exact.norm(), wanted.force_floor);
  }
  Json toJson() const {
    return {{"kept", kept / std::max(1.0, static_cast<double>(relative.size()))},
            {"median", quantile(relative, 0.5)},
            {"p90", quantile(relative, 0.9)},
            {"p97", quantile(relative, 0.97)}};
  }
};

enum class Exact { found, too_strong, none };

/// By continuation from rest, in steps of a lattice spacing; it ends where the device would.
std::pair<Exact, Eigen::Vector3d> exactForce(TransitionSolver& solver, const Problem& problem,
                                             const Probe& probe, double radius) {
  solver.placeFinger("probe", {probe.place, radius});
  Failure of_rest;
  auto at = solver.startAtRest(of_rest);
  if (!at) throw failure("rest: {}", describe(of_rest));
  const Workspace& workspace = problem.scene.workspace;
  const int steps =
      std::max(1, static_cast<int>(std::ceil(probe.displacement.norm() / workspace.spacing)));
  Reached reached;
  for (int n = 1; n <= steps; ++n) {
    reached = solver.reach(*at, probe.displacement * n / steps);
    if (!reached.outcome.converged) return {Exact::none, Eigen::Vector3d::Zero()};
    if (reached.outcome.equilibrium.force.norm() > workspace.max_force)
      return {Exact::too_strong, Eigen::Vector3d::Zero()};
    at = std::move(reached.end);
  }
  return {Exact::found, reached.outcome.equilibrium.force};
}

/// Of one query, the fastest of some rounds over all of them.
double queryMicroseconds(const AreaField& area, const std::vector<Probe>& probes) {
  double fastest = std::numeric_limits<double>::infinity(), sum = 0;
  for (int round = 0; round < 20; ++round) {
    const auto began = std::chrono::steady_clock::now();
    for (const Probe& probe : probes)
      sum += area.evaluate(probe.place, probe.displacement).force.x();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - began;
    fastest = std::min(fastest, took.count() / static_cast<double>(probes.size()));
  }
  if (!std::isfinite(sum)) throw failure("an answered probe has no force");
  return fastest;
}

Json run(const Options& options) {
  const Problem problem = loadProblem(options.scene);
  const Dataset dataset(options.dataset);
  const ActiveChoice choice = chooseActive(dataset.scene(), options.area);
  const auto sites = chosenOf(dataset.spaces(), choice.spaces);
  const double radius = sites.front()->patch.finger.value().radius;
  const auto began = std::chrono::steady_clock::now();
  const AreaField area(sites, placesAround(dataset.mesh(), centersOf(sites), radius));
  const std::chrono::duration<double> preparing = std::chrono::steady_clock::now() - began;
  std::vector<std::unique_ptr<PotentialField>> fields(sites.size());

  TransitionSolver solver(problem, chooseKernels());
  Drawing drawing(problem.mesh, radius, problem.scene.workspace.radius, options.cone, options.seed);
  Errors of_area, of_nearest;
  std::vector<double> over_error;
  std::vector<Probe> probes;
  int unsolved = 0, too_strong = 0, held = 0;
  while (static_cast<int>(of_area.relative.size()) < options.probes) {
    const Probe probe = drawing.draw();
    const AreaSample sample = area.evaluate(probe.place, probe.displacement);
    if (!std::isfinite(sample.error_bound)) continue;  // no site near
    if (fingerWeights(problem.mesh, problem.fixed, probe.place, radius).free_share <
        least_free_share)
      continue;
    const auto [outcome, force] = exactForce(solver, problem, probe, radius);
    unsolved += outcome == Exact::none ? 1 : 0;
    too_strong += outcome == Exact::too_strong ? 1 : 0;
    if (outcome != Exact::found) continue;
    probes.push_back(probe);
    of_area.record(sample.force, force, problem.scene.accuracy);
    const double error = (sample.force - force).norm();
    held += error <= sample.error_bound;
    over_error.push_back(sample.error_bound / error);
    const auto nearest = static_cast<std::size_t>(
        std::ranges::min_element(sites, {},
                                 [&](const SpaceTable* site) {
                                   return (site->patch.finger->center - probe.place).norm();
                                 }) -
        sites.begin());
    if (!fields[nearest]) fields[nearest] = std::make_unique<PotentialField>(*sites[nearest]);
    of_nearest.record(fields[nearest]->evaluate(probe.displacement).force, force,
                      problem.scene.accuracy);
  }
  return {{"benchmark", "area_probes"},
          {"scene", problem.scene.name},
          {"sites", sites.size()},
          {"stations", area.stationCount()},
          {"preparing_seconds", preparing.count()},
          {"query_us", queryMicroseconds(area, probes)},
          {"probes", options.probes},
          {"beyond_max_force", too_strong},
          {"without_solution", unsolved},
          {"area", of_area.toJson()},
          {"nearest_site", of_nearest.toJson()},
          {"bound_holds", held / static_cast<double>(options.probes)},
          {"bound_over_error_median", quantile(over_error, 0.5)}};
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
  palpate::Options options;
  CLI::App app("Errors of a finger's area between its sites");
  app.add_option("SCENE", options.scene)->required();
  app.add_option("DATASET", options.dataset)->required();
  app.add_option("--active", options.area);
  app.add_option("--probes", options.probes);
  app.add_option("--seed", options.seed);
  app.add_option("--cone", options.cone, "Degrees from the inward normal");
  CLI11_PARSE(app, argc, argv);
  fmt::print("{}\n", palpate::run(options).dump(2));
} catch (const std::exception& error) {
  fmt::print(stderr, "{}\n", error.what());
  return 1;
}
