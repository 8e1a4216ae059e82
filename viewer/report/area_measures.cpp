#include "viewer/report/area_measures.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "common/base/parallel.hpp"
#include "common/problem/sites.hpp"
#include "common/scene/active_choice.hpp"
#include "viewer/fields/area_field.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr std::array<double, 5> depths = {0.2, 0.4, 0.6, 0.8, 1.0};  ///< of the ball's radius
constexpr int sideways = 4;  ///< directions 45 degrees off the normal, beside the normal itself

/// What was asked at one depth of one triangle.
struct Sample {
  double bound, force;
};

/// Unit vectors into the body.
std::array<Eigen::Vector3d, sideways + 1> directionsInto(const Eigen::Vector3d& normal) {
  const Eigen::Vector3d across = normal.unitOrthogonal(), along = normal.cross(across);
  return {-normal, (across - normal).normalized(), (-across - normal).normalized(),
          (along - normal).normalized(), (-along - normal).normalized()};
}

double medianOf(const std::vector<double>& values) { return spreadOf(values).median; }

AreaMeasures measureArea(const Dataset& dataset, const ActiveChoice& choice,
                         const AccuracyTarget& target) {
  const auto spaces = chosenOf(dataset.spaces(), choice.spaces);
  const Mesh& mesh = dataset.mesh();
  const auto began = Clock::now();
  const AreaField area(spaces,
                       placesAround(mesh, centersOf(spaces), spaces.front()->patch.finger->radius));
  AreaMeasures measures;
  measures.name = choice.name;
  measures.sites = spaces.size();
  measures.stations = area.stationCount();
  measures.seconds_to_prepare = Seconds(Clock::now() - began).count();

  const double radius = spaces.front()->lattice.radius();
  const double largest_force = dataset.scene().workspace.max_force;
  const auto n_triangles = mesh.surface.size();
  std::vector<std::array<std::vector<Sample>, depths.size()>> found(n_triangles);
  const auto asked = Clock::now();
  for (std::size_t t = 0; t < n_triangles; ++t) {
    const Triangle& corners = mesh.surface[t];
    const Eigen::Vector3d &a = mesh.nodes[at(corners[0])], &b = mesh.nodes[at(corners[1])],
                          &c = mesh.nodes[at(corners[2])];
    const Eigen::Vector3d middle = (a + b + c) / 3, normal = (b - a).cross(c - a).normalized();
    for (std::size_t d = 0; d < depths.size(); ++d)
      for (const Eigen::Vector3d& direction : directionsInto(normal)) {
        const AreaSample sample = area.evaluate(middle, depths[d] * radius * direction);
        const double force = sample.force.norm();
        if (!sample.inside || !std::isfinite(sample.error_bound) || force > largest_force) continue;
        found[t][d].push_back(
            {sample.error_bound / std::max(force, target.force_floor / target.force_error), force});
      }
  }
  measures.nanoseconds = 1e9 * Seconds(Clock::now() - asked).count() /
                         static_cast<double>(n_triangles * depths.size() * (sideways + 1));

  std::vector<double> all;
  for (std::size_t d = 0; d < depths.size(); ++d) {
    std::vector<double> bounds, forces;
    for (const auto& of_triangle : found)
      for (const Sample& sample : of_triangle[d]) {
        bounds.push_back(sample.bound);
        forces.push_back(sample.force);
      }
    all.insert(all.end(), bounds.begin(), bounds.end());
    measures.depths.push_back({depths[d] * radius, spreadOf(bounds), spreadOf(forces).mean});
  }
  measures.samples = all.size();
  measures.bound = spreadOf(std::move(all));
  for (const auto& of_triangle : found) {
    std::vector<double> bounds;
    for (const auto& of_depth : of_triangle)
      for (const Sample& sample : of_depth) bounds.push_back(sample.bound);
    measures.on_triangles.push_back(medianOf(bounds));
  }
  return measures;
}

}  // namespace

std::vector<AreaMeasures> measureAreas(const Dataset& dataset, const AccuracyTarget& target) {
  std::vector<AreaMeasures> measures;
  for (const ActiveChoice& area : areasOf(dataset.scene()))
    measures.push_back(measureArea(dataset, area, target));
  return measures;
}

}  // namespace palpate
