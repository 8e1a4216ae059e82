#pragma once

#include <functional>

#include "viewer/fields/force_field.hpp"
#include "viewer/report/held_out.hpp"

namespace palpate {

/// Displacements along one direction from rest, m, and the force components in that direction, N;
/// of equal length.
struct AxisForces {
  std::vector<double> displacements, forces;

  void add(double displacement, double force);
};

/// Interpolated and exact forces on a straight path from rest.
struct ForceWay {
  std::string name;                                      ///< for people
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit
  AxisForces solved{};                                   ///< equilibria that the interpolations use
  AxisForces held_out{};                                 ///< exact solutions that they do not use
  std::vector<AxisForces> sampled{};  ///< one per interpolation; empty if it could not be made
};

/// Largest distance from the path, as a share of the radius, of a point that counts as on it.
inline constexpr double on_way = 1e-6;

/// Returns the solved points of a space on the path from rest along `direction`; with `both`, on
/// both sides of rest.
AxisForces solvedOnWay(const SpaceTable& space, const Eigen::Vector3d& direction, bool both);

/// As solvedOnWay(), for exact solutions. radius: of the ball, m.
AxisForces heldOutOnWay(const std::vector<HeldOutSolution>& solutions, double radius,
                        const Eigen::Vector3d& direction, bool both);

/// Samples `force` (N, of a displacement in m) from displacement `from` to `to`, m. NaN stays NaN.
AxisForces sampledOnWay(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& force,
                        const Eigen::Vector3d& direction, double from, double to);

/// Returns the indices of the largest value, the 95th percentile and the median, with their names;
/// fewer if they coincide. Ignores values that are not finite.
std::vector<std::pair<std::size_t, const char*>> tellingOnes(const std::vector<double>& values);

}  // namespace palpate
