#include "viewer/report/field_comparison.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <random>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int timed_positions = 4096, batch = 256;

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Methods whose coverage depends only on the corners of the cell around a displacement.
constexpr std::array<std::string_view, 2> cell_methods = {"trilinear", "potential"};

std::vector<Eigen::Vector3d> positionsInBall(double radius) {
  // Use the numbers of the random engine itself, which are the same on all systems, unlike those of
  // the library's distributions.
  std::mt19937 random(7);
  const auto coordinate = [&] {
    return radius * (static_cast<double>(random()) / 2147483648.0 - 1);
  };
  std::vector<Eigen::Vector3d> positions;
  while (positions.size() < timed_positions) {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    if (const Eigen::Vector3d p(x, y, z); p.norm() <= radius) positions.push_back(p);
  }
  return positions;
}

double medianQuery(const ForceField& field, double radius, double budget) {
  // Choose the positions before the clock starts.
  const std::vector<Eigen::Vector3d> positions = positionsInBall(radius);
  std::vector<double> times;
  double sum = 0;
  std::size_t next = 0;
  const Clock::time_point begin = Clock::now();
  do {
    const Clock::time_point start = Clock::now();
    for (int n = 0; n < batch; ++n) sum += field.evaluate(positions[next + n]).force.x();
    times.push_back(seconds(Clock::now() - start) / batch * 1e9);
    next = (next + batch) % timed_positions;
  } while (seconds(Clock::now() - begin) < budget);
  // Use the sum, so that the compiler does not remove the queries.
  [[maybe_unused]] const volatile double used = sum;
  return spreadOf(std::move(times)).median;
}

constexpr int candidates = 256, most_circles = 64, points_per_circle = 4096;

struct Circle {
  Eigen::Vector3d center, first, second;  ///< metres; two orthogonal vectors from the centre to the
                                          ///< circle
};

/// Returns the relative work around a circle; nullopt if the coverage is too low anywhere on it.
std::optional<double> relativeWork(const ForceField& field, const Circle& circle,
                                   double least_coverage) {
  double work = 0, effort = 0;
  for (int n = 0; n < points_per_circle; ++n) {
    const double angle = 2 * M_PI * (n + 0.5) / points_per_circle;
    const double c = std::cos(angle), s = std::sin(angle);
    const ForceSample sample = field.evaluate(circle.center + c * circle.first + s * circle.second);
    if (!sample.inside || sample.coverage < least_coverage) return std::nullopt;
    const Eigen::Vector3d tangent = c * circle.second - s * circle.first;
    work += sample.force.dot(tangent);
    effort += sample.force.norm() * tangent.norm();
  }
  return effort > 0 ? std::abs(work) / effort : 0;
}

}  // namespace

double loopWork(const ForceField& field, double radius, double least_coverage) {
  std::mt19937 random(20);  // the same circles for every field
  const auto uniform = [&] { return (static_cast<double>(random()) + 0.5) / 4294967296.0; };
  const auto direction = [&] {
    const double z = 2 * uniform() - 1, turn = uniform();
    return onSphere(z, turn);
  };
  double largest = std::nan("");
  for (int candidate = 0, used = 0; candidate < candidates && used < most_circles; ++candidate) {
    const Eigen::Vector3d first = direction(), other = direction(), outwards = direction();
    const double distance = 0.75 * radius * std::cbrt(uniform());
    const Circle circle = {distance * outwards, 0.25 * radius * first,
                           0.25 * radius * first.cross(other).normalized()};
    const auto work = relativeWork(field, circle, least_coverage);
    if (!work) continue;
    ++used;
    // fmax ignores the NaN at the start.
    largest = std::fmax(largest, *work);
  }
  return largest;
}

bool isCovered(const ForceSample& sample) noexcept {
  return sample.inside && sample.coverage > 1 - 1e-9;
}

Eigen::Vector3d forceInside(const ForceSample& sample) noexcept {
  return sample.inside ? sample.force : Eigen::Vector3d::Constant(not_measured);
}

MadeField tryToMake(const std::string& method, const SpaceTable& space) {
  // If one method cannot be made of these points, the report still shows the others.
  try {
    return {makeForceField(method, space), ""};
  } catch (const std::bad_alloc&) {
    return {nullptr, "not enough memory"};
  } catch (const Error& error) {
    return {nullptr, error.what()};
  }
}

std::vector<MethodComparison> compareMethods(const SpaceTable& space,
                                             const std::vector<std::string>& methods,
                                             const std::vector<HeldOutSolution>& held_out,
                                             bool with_loops) {
  std::vector<MethodComparison> results(methods.size());
  std::unique_ptr<ForceField> cells;
  for (std::size_t m = 0; m < methods.size(); ++m) {
    MadeField made = tryToMake(methods[m], space);
    results[m].problem = made.problem;
    if (!made.field) continue;
    if (with_loops) results[m].loop_work = loopWork(*made.field, space.lattice.radius());
    for (const HeldOutSolution& solution : held_out) {
      const ForceSample sample = made.field->evaluate(solution.displacement);
      results[m].comparisons.push_back(
          {solution.force, sample.force, sample.error_bound, false, solution.displacement.norm()});
    }
    if (!cells && std::ranges::find(cell_methods, methods[m]) != cell_methods.end())
      cells = std::move(made.field);
  }
  // If no cell method was made, make one just to find the covered solutions.
  if (!cells && !held_out.empty())
    cells = tryToMake(std::string(cell_methods.front()), space).field;
  if (!cells) return results;
  for (const MethodComparison& result : results)
    PALPATE_ASSERT(result.comparisons.empty() || result.comparisons.size() == held_out.size(),
                   "each method must be evaluated at every solution");
  for (std::size_t n = 0; n < held_out.size(); ++n) {
    const bool covered = isCovered(cells->evaluate(held_out[n].displacement));
    for (MethodComparison& result : results)
      if (!result.comparisons.empty()) result.comparisons[n].covered = covered;
  }
  return results;
}

MethodTiming timeMethod(const SpaceTable& space, const std::string& method, double budget) {
  const Clock::time_point start = Clock::now();
  const MadeField made = tryToMake(method, space);
  const double prepared = seconds(Clock::now() - start);
  if (!made.field) return {};
  return {medianQuery(*made.field, space.lattice.radius(), budget), prepared};
}

}  // namespace palpate
