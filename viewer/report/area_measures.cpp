#include "viewer/report/area_measures.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/base/index.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/sites.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/fields/potential_field.hpp"
#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr std::array<double, 5> depths = {0.2, 0.4, 0.6, 0.8, 1.0};  ///< multiples of the radius of
                                                                     ///< the ball
constexpr std::size_t shown_sites = 3;
constexpr int sideways = 4;  ///< number of directions at 45 degrees to the normal

/// Relative error bound and force (N) for one displacement at the centroid of a triangle.
struct Sample {
  double bound, force;
};

/// Returns unit vectors that point into the body: the inward normal, and those at 45 degrees to it.
std::array<Eigen::Vector3d, sideways + 1> directionsInto(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d across = normal.unitOrthogonal(), along = normal.cross(across);
  return {-normal, (across - normal).normalized(), (-across - normal).normalized(),
          (along - normal).normalized(), (-along - normal).normalized()};
}

/// Returns the factor that makes an error relative, 1/N: 1 / force, or force_error / force_floor if
/// that is smaller.
double relativeTo(double force, const AccuracyTarget& target) {
  return 1 / std::max(force, target.force_floor / target.force_error);
}

/// Samples of an area, [triangle of the mesh's surface][depth].
using Samples = std::vector<std::array<std::vector<Sample>, depths.size()>>;

/// Samples the area at the centroid of every triangle. Leaves out displacements without a bound,
/// and those with a force above the scene's max_force.
Samples samplesOf(const AreaField& area, const Dataset& dataset, double radius,
                  const AccuracyTarget& target) {
  const Mesh& mesh = dataset.mesh();
  const double largest_force = dataset.scene().workspace.max_force;
  Samples found(mesh.surface.size());
  for (std::size_t t = 0; t < found.size(); ++t) {
    const auto [a, b, c] = cornersOf(mesh.nodes, mesh.surface[t]);
    const Eigen::Vector3d middle = (a + b + c) / 3, normal = (b - a).cross(c - a).normalized();
    for (std::size_t d = 0; d < depths.size(); ++d)
      for (const Eigen::Vector3d& direction : directionsInto(normal)) {
        const AreaSample sample = area.evaluate(middle, depths[d] * radius * direction);
        const double force = sample.force.norm();
        if (!sample.inside || !std::isfinite(sample.error_bound) || force > largest_force) continue;
        found[t][d].push_back({relativeTo(force, target) * sample.error_bound, force});
      }
  }
  return found;
}

void measureBounds(const Samples& found, double radius, AreaMeasures& measures) {
  std::vector<double> all;
  for (std::size_t d = 0; d < depths.size(); ++d) {
    std::vector<double> bounds, forces;
    for (const auto& of_triangle : found)
      for (const Sample& sample : of_triangle[d]) {
        bounds.push_back(sample.bound);
        forces.push_back(sample.force);
      }
    all.insert(all.end(), bounds.begin(), bounds.end());
    measures.depths.push_back({.depth = depths[d] * radius,
                               .bound = spreadOf(bounds),
                               .force = spreadOf(forces).mean,
                               .exact = 0,
                               .error = {}});
  }
  measures.samples = all.size();
  measures.bound = spreadOf(std::move(all));
  for (const auto& of_triangle : found) {
    std::vector<double> bounds;
    for (const auto& of_depth : of_triangle)
      for (const Sample& sample : of_depth) bounds.push_back(sample.bound);
    const Spread spread = spreadOf(std::move(bounds));
    measures.on_triangles.push_back(spread.median);
    measures.worst_on_triangles.push_back(spread.maximum);
  }
}

void measureDepths(AreaMeasures& measures) {
  measures.probes.error =
      spreadOf(mapped(measures.probes.comparisons, &AreaProbes::Comparison::error));
  double before = 0;
  for (DepthMeasures& depth : measures.depths) {
    std::vector<double> errors;
    for (const AreaProbes::Comparison& probe : measures.probes.comparisons)
      if (const double p = probe.displacement.norm(); p > before && p <= depth.depth * (1 + 1e-9))
        errors.push_back(probe.error);
    depth.exact = errors.size();
    depth.error = spreadOf(std::move(errors));
    before = depth.depth * (1 + 1e-9);
  }
}

/// Evaluates the space of the nearest site alone. Makes the field of a site when it is first used.
class NearestSite {
 public:
  explicit NearestSite(const std::vector<const SpaceTable*>& sites)
      : sites_(sites), fields_(sites.size()) {}
  Eigen::Vector3d force(const Eigen::Vector3d& place, const Eigen::Vector3d& displacement) {
    const auto distance = [&](const SpaceTable* site) {
      return (site->patch.finger->center - place).norm();
    };
    const auto nearest = std::ranges::min_element(sites_, {}, distance) - sites_.begin();
    std::unique_ptr<PotentialField>& field = fields_[at(nearest)];
    if (!field) field = std::make_unique<PotentialField>(*sites_[at(nearest)]);
    return field->evaluate(displacement).force;
  }

 private:
  const std::vector<const SpaceTable*>& sites_;
  std::vector<std::unique_ptr<PotentialField>> fields_;
};

AreaProbes measureProbes(const AreaField& area, NearestSite& nearest,
                         const std::vector<const SpaceTable*>& places,
                         const AccuracyTarget& target) {
  AreaProbes measures;
  std::vector<ForceComparison> of_area, of_nearest;
  for (const SpaceTable* place : places) {
    // If a place has no rest position, it has no probe.
    const auto& [displacement, record] = place->probes.empty() ? Probe() : place->probes.front();
    measures.counts.add(record);
    if (record.tag != Tag::expandable) continue;
    const Eigen::Vector3d& center = place->patch.finger->center;
    const AreaSample sample = area.evaluate(center, displacement);
    measures.unanswered += !std::isfinite(sample.error_bound);
    const Eigen::Vector3d& exact = record.equilibrium.force;
    of_area.push_back({exact, sample.force, sample.error_bound});
    of_nearest.push_back({exact, nearest.force(center, displacement)});
    const double error = (sample.force - exact).norm();
    measures.comparisons.push_back({center, displacement, exact,
                                    relativeTo(exact.norm(), target) * error, error,
                                    (of_nearest.back().interpolated - exact).norm()});
  }
  measures.area = measureErrors(of_area, target);
  measures.nearest_site = measureErrors(of_nearest, target);
  return measures;
}

void sampleWay(const AreaField& area, NearestSite& nearest, const Eigen::Vector3d& place,
               double length, ForceWay& way) {
  way.sampled.push_back(
      sampledOnWay([&](const Eigen::Vector3d& p) { return forceInside(area.evaluate(place, p)); },
                   way.direction, 0, length));
  way.sampled.push_back(sampledOnWay(
      [&](const Eigen::Vector3d& p) { return nearest.force(place, p); }, way.direction, 0, length));
}

/// Returns the lattice axis that points most into the body at a place, with its sign.
Eigen::Vector3d axisInto(const Mesh& mesh, const Eigen::Vector3d& place) {
  const Eigen::Vector3d into = -normalOf(mesh, nearestOnSurface(mesh, place).triangle);
  Eigen::Index axis = 0;
  into.cwiseAbs().maxCoeff(&axis);
  return std::copysign(1, into[axis]) * Eigen::Vector3d::Unit(axis);
}

std::vector<ForceWay> waysOf(const AreaField& area, NearestSite& nearest, const Mesh& mesh,
                             const std::vector<const SpaceTable*>& sites,
                             const AreaProbes& probes) {
  std::vector<ForceWay> ways;
  for (std::size_t n = 0; n < std::min(shown_sites, sites.size()); ++n) {
    const SpaceTable& site = *sites[n * sites.size() / std::min(shown_sites, sites.size())];
    const Eigen::Vector3d& place = site.patch.finger->center;
    ForceWay way = {.name = site.patch.name, .direction = axisInto(mesh, place)};
    way.solved = solvedOnWay(site, way.direction, false);
    sampleWay(area, nearest, place, site.lattice.radius(), way);
    ways.push_back(std::move(way));
  }
  const auto errors = mapped(probes.comparisons, &AreaProbes::Comparison::error);
  for (const auto& [n, name] : tellingOnes(errors)) {
    const AreaProbes::Comparison& probe = probes.comparisons[n];
    if (!(probe.displacement.norm() > 0)) continue;
    ForceWay way = {.name = name, .direction = probe.displacement.normalized()};
    way.held_out.add(probe.displacement.norm(), probe.force.dot(way.direction));
    sampleWay(area, nearest, probe.place, sites.front()->lattice.radius(), way);
    ways.push_back(std::move(way));
  }
  return ways;
}

AreaMeasures measureArea(const Dataset& dataset, const ActiveChoice& choice,
                         const AccuracyTarget& target) {
  const auto spaces = chosenOf(dataset.spaces(), choice.spaces);
  const auto began = Clock::now();
  const AreaField area(spaces, placesAround(dataset.mesh(), centersOf(spaces),
                                            spaces.front()->patch.finger->radius));
  AreaMeasures measures;
  measures.name = choice.name;
  measures.sites = spaces.size();
  measures.collocation_points = area.collocationPointCount();
  measures.seconds_to_prepare = Seconds(Clock::now() - began).count();

  const double radius = spaces.front()->lattice.radius();
  const auto asked = Clock::now();
  const Samples samples = samplesOf(area, dataset, radius, target);
  measures.nanoseconds = 1e9 * Seconds(Clock::now() - asked).count() /
                         static_cast<double>(samples.size() * depths.size() * (sideways + 1));
  measureBounds(samples, radius, measures);
  NearestSite nearest(spaces);
  measures.probes =
      measureProbes(area, nearest, chosenOf(dataset.probePlaces(), choice.probe_places), target);
  measureDepths(measures);
  measures.ways = waysOf(area, nearest, dataset.mesh(), spaces, measures.probes);
  for (const SpaceTable* site : spaces) measures.jumps += site->inconsistent_edges.size();
  return measures;
}

}  // namespace

std::vector<AreaMeasures> measureAreas(const Dataset& dataset, const AccuracyTarget& target) {
  return mapped(areasOf(dataset.scene()),
                [&](const ActiveChoice& area) { return measureArea(dataset, area, target); });
}

}  // namespace palpate
