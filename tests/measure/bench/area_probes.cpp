// Error of the energy of a finger's area between its sites. Compares a dataset with exact solutions
// at random places and displacements, and with alternatives: the nearest site alone (as in the
// paper), a barycentric blend of the forces of the three nearest sites, and the same energy from
// evenly spaced sites, which are fewer at edges. Prints one JSON object.
//
// Places are uniform over the surface that the sites cover; displacements are uniform over the part
// of the ball within `cone` of the inward normal. Probes whose exact force exceeds the scene's
// max_force, or that have no solution by continuation from rest, are counted separately.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/dataset/dataset.hpp"
#include "common/mesh/near_points.hpp"
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

/// Uniform over the surface, and over the cone at each place.
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

/// Answers of single sites.
class SingleSites {
 public:
  explicit SingleSites(const std::vector<const SpaceTable*>& sites)
      : sites_(sites), fields_(sites.size()) {}

  Eigen::Vector3d nearest(const Probe& probe) { return forceOf(nearestOf(probe)[0], probe); }

  /// Weights the three sites by their barycentric coordinates; places outside their triangle are
  /// projected to it.
  Eigen::Vector3d blended(const Probe& probe) {
    const std::array<std::size_t, 3> corners = nearestOf(probe);
    Eigen::Matrix<double, 3, 2> edges;
    edges << centerOf(corners[1]) - centerOf(corners[0]),
        centerOf(corners[2]) - centerOf(corners[0]);
    const Eigen::Vector2d inner =
        edges.colPivHouseholderQr().solve(probe.place - centerOf(corners[0]));
    Eigen::Vector3d weights(1 - inner.sum(), inner[0], inner[1]);
    weights = weights.cwiseMax(0) / weights.cwiseMax(0).sum();
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) force += weights[c] * forceOf(corners[at(c)], probe);
    return force;
  }

 private:
  const Eigen::Vector3d& centerOf(std::size_t site) const {
    return sites_[site]->patch.finger->center;
  }
  std::array<std::size_t, 3> nearestOf(const Probe& probe) const {
    std::vector<std::size_t> numbers(sites_.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    std::ranges::partial_sort(numbers, numbers.begin() + 3, {}, [&](std::size_t site) {
      return (centerOf(site) - probe.place).norm();
    });
    return {numbers[0], numbers[1], numbers[2]};
  }
  Eigen::Vector3d forceOf(std::size_t site, const Probe& probe) {
    if (!fields_[site]) fields_[site] = std::make_unique<PotentialField>(*sites_[site]);
    return fields_[site]->evaluate(probe.displacement).force;
  }

  const std::vector<const SpaceTable*>& sites_;
  std::vector<std::unique_ptr<PotentialField>> fields_;
};

/// The sites that remain if edges get no extra sites.
std::vector<const SpaceTable*> evenly(const std::vector<const SpaceTable*>& sites, double radius) {
  const std::vector<Eigen::Vector3d> centers = centersOf(sites);
  const std::vector<double> distances(sites.size(), site_distance * radius);
  const auto any = [](const Eigen::Vector3d&, std::size_t) { return true; };
  std::vector<const SpaceTable*> chosen;
  for (const Eigen::Vector3d& center : farthestPoints(centers, distances, any))
    chosen.push_back(sites[at(std::ranges::find(centers, center) - centers.begin())]);
  return chosen;
}

/// Errors of one method.
struct Errors {
  std::vector<double> relative, over_error;
  int kept = 0, held = 0;
  void record(const AreaSample& sample, const Eigen::Vector3d& exact, const Accuracy& wanted) {
    record(sample.force, exact, wanted);
    const double error = (sample.force - exact).norm();
    held += error <= sample.error_bound;
    over_error.push_back(sample.error_bound / error);
  }
  void record(const Eigen::Vector3d& found, const Eigen::Vector3d& exact, const Accuracy& wanted) {
    const double error = (found - exact).norm();
    relative.push_back(error / exact.norm());
    const double share = wanted.adaptive() ? wanted.force_error : 0.03;
    kept += error <= std::max(share * exact.norm(), wanted.force_floor);
  }
  Json toJson() const {
    const double count = std::max(1.0, static_cast<double>(relative.size()));
    Json json = {{"kept", kept / count},
                 {"median", quantile(relative, 0.5)},
                 {"p90", quantile(relative, 0.9)},
                 {"p97", quantile(relative, 0.97)}};
    if (over_error.empty()) return json;
    json["bound_holds"] = held / count;
    json["bound_over_error_median"] = quantile(over_error, 0.5);
    return json;
  }
};

enum class Exact { found, too_strong, none };

/// By continuation from rest in steps of a lattice spacing, up to the force limit.
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
    if (!reached.outcome.converged()) return {Exact::none, Eigen::Vector3d::Zero()};
    if (reached.outcome.equilibrium().force.norm() > workspace.max_force)
      return {Exact::too_strong, Eigen::Vector3d::Zero()};
    at = std::move(reached.end);
  }
  return {Exact::found, reached.outcome.equilibrium().force};
}

/// Time of one query: the fastest of several rounds over all queries.
template <class Round>
double microseconds(int rounds, std::size_t queries, Round round) {
  double fastest = std::numeric_limits<double>::infinity(), sum = 0;
  for (int n = 0; n < rounds; ++n) {
    const auto began = std::chrono::steady_clock::now();
    sum += round();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - began;
    fastest = std::min(fastest, took.count() / static_cast<double>(queries));
  }
  if (!std::isfinite(sum)) throw failure("an answered place has no force or energy");
  return fastest;
}

/// Time at random places.
double randomMicroseconds(const AreaField& area, const std::vector<Probe>& probes) {
  return microseconds(20, probes.size(), [&] {
    double sum = 0;
    for (const Probe& probe : probes)
      sum += area.evaluate(probe.place, probe.displacement).force.x();
    return sum;
  });
}

/// Time along strokes of 10 mm from each place, 0.1 mm per query, as a hand slides at 1 kHz.
double slidingMicroseconds(const AreaField& area, const std::vector<Probe>& probes) {
  constexpr std::size_t steps = 100;
  const Eigen::Vector3d step(1e-4, 0, 0);
  return microseconds(3, steps * probes.size(), [&] {
    double sum = 0;
    for (const Probe& probe : probes)
      for (std::size_t n = 0; n < steps; ++n)
        sum += area.evaluate(probe.place + static_cast<double>(n) * step, probe.displacement)
                   .force.x();
    return sum;
  });
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
  const std::vector<const SpaceTable*> even = evenly(sites, radius);
  const AreaField even_area(even, placesAround(dataset.mesh(), centersOf(even), radius));
  if (sites.size() < 3) throw badInput("{}: three sites are blended at least", choice.name);
  SingleSites single(sites);

  TransitionSolver solver(problem, chooseKernels());
  Drawing drawing(problem.mesh, radius, problem.scene.workspace.radius, options.cone, options.seed);
  Errors of_area, of_even, of_blend, of_nearest;
  std::vector<Probe> probes;
  int unsolved = 0, too_strong = 0;
  while (static_cast<int>(of_area.relative.size()) < options.probes) {
    const Probe probe = drawing.draw();
    const AreaSample sample = area.evaluate(probe.place, probe.displacement);
    if (!std::isfinite(sample.error_bound)) continue;  // no site is near
    if (fingerWeights(problem.mesh, problem.fixed, probe.place, radius).free_share <
        least_free_share)
      continue;
    const auto [outcome, force] = exactForce(solver, problem, probe, radius);
    unsolved += outcome == Exact::none ? 1 : 0;
    too_strong += outcome == Exact::too_strong ? 1 : 0;
    if (outcome != Exact::found) continue;
    probes.push_back(probe);
    const Accuracy& wanted = problem.scene.accuracy;
    of_area.record(sample, force, wanted);
    of_even.record(even_area.evaluate(probe.place, probe.displacement), force, wanted);
    of_blend.record(single.blended(probe), force, wanted);
    of_nearest.record(single.nearest(probe), force, wanted);
  }
  return {{"benchmark", "area_probes"},
          {"scene", problem.scene.name},
          {"sites", sites.size()},
          {"collocation_points", area.collocationPointCount()},
          {"preparing_seconds", preparing.count()},
          {"query_us", randomMicroseconds(area, probes)},
          {"sliding_query_us", slidingMicroseconds(area, probes)},
          {"probes", options.probes},
          {"beyond_max_force", too_strong},
          {"without_solution", unsolved},
          {"area", of_area.toJson()},
          {"uniform_sites", even.size()},
          {"area_of_uniform_sites", of_even.toJson()},
          {"barycentric_blend", of_blend.toJson()},
          {"nearest_site", of_nearest.toJson()}};
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
