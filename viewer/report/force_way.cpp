#include "viewer/report/force_way.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/index.hpp"

namespace palpate {
namespace {

constexpr int way_samples = 121;

bool liesOnWay(const Eigen::Vector3d& p, const Eigen::Vector3d& direction, double radius,
               bool both) {
  const double along = p.dot(direction);
  return (both || along >= 0) && (p - along * direction).norm() <= on_way * radius;
}

}  // namespace

void AxisForces::add(double displacement, double force) {
  displacements.push_back(displacement);
  forces.push_back(force);
}

AxisForces solvedOnWay(const SpaceTable& space, const Eigen::Vector3d& direction, bool both) {
  AxisForces solved;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Eigen::Vector3d p = space.lattice.displacement(n);
    if (isSolved(space.points[n].tag) && p.norm() <= space.lattice.radius() * (1 + 1e-9) &&
        liesOnWay(p, direction, space.lattice.radius(), both))
      solved.add(p.dot(direction), space.points[n].equilibrium.force.dot(direction));
  }
  return solved;
}

AxisForces heldOutOnWay(const std::vector<HeldOutSolution>& solutions, double radius,
                        const Eigen::Vector3d& direction, bool both) {
  AxisForces held_out;
  for (const HeldOutSolution& solution : solutions)
    if (liesOnWay(solution.displacement, direction, radius, both))
      held_out.add(solution.displacement.dot(direction), solution.force.dot(direction));
  return held_out;
}

AxisForces sampledOnWay(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& force,
                        const Eigen::Vector3d& direction, double from, double to) {
  AxisForces sampled;
  for (int n = 0; n < way_samples; ++n) {
    const double distance = std::lerp(from, to, static_cast<double>(n) / (way_samples - 1));
    sampled.add(distance, force(distance * direction).dot(direction));
  }
  return sampled;
}

std::vector<std::pair<std::size_t, const char*>> tellingOnes(const std::vector<double>& values) {
  std::vector<std::size_t> order = countUp<std::size_t>(values.size());
  std::erase_if(order, [&](std::size_t n) { return !std::isfinite(values[n]); });
  std::ranges::stable_sort(order, {}, [&](std::size_t n) { return values[n]; });
  std::vector<std::pair<std::size_t, const char*>> chosen;
  if (order.empty()) return chosen;
  for (const auto& [share, name] :
       {std::pair(1.0, "largest error"), std::pair(0.95, "error at 95 %"),
        std::pair(0.5, "median error")}) {
    const std::size_t n =
        order[static_cast<std::size_t>(std::lround(share * static_cast<double>(order.size() - 1)))];
    if (std::ranges::find(chosen, n, &std::pair<std::size_t, const char*>::first) == chosen.end())
      chosen.emplace_back(n, name);
  }
  return chosen;
}

}  // namespace palpate
