#include "viewer/report/field_comparison.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <random>

#include "common/base/error.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/report/loop_work.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int timed_positions = 4096, batch = 256;

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

/// Methods whose samples tell what is covered: they interpolate in cells.
constexpr std::array<std::string_view, 2> cell_methods = {"trilinear", "potential"};

std::vector<Eigen::Vector3d> positionsInBall(double radius) {
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
  [[maybe_unused]] const volatile double used = sum;
  return spreadOf(std::move(times)).median;
}

}  // namespace

bool isCovered(const ForceSample& sample) noexcept {
  return sample.inside && sample.coverage > 1 - 1e-9;
}

MadeField tryToMake(const std::string& method, const SpaceTable& space) {
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
      results[m].comparisons.push_back({solution.force, sample.force, sample.error_bound, false});
    }
    if (!cells && std::ranges::find(cell_methods, methods[m]) != cell_methods.end())
      cells = std::move(made.field);
  }
  if (!cells && !held_out.empty())
    cells = tryToMake(std::string(cell_methods.front()), space).field;
  if (!cells) return results;
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
