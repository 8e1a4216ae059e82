#pragma once

#include <functional>

#include "viewer/fields/force_field.hpp"
#include "viewer/report/held_out.hpp"

namespace palpate {

/// Displacements along one direction from rest, m, and the component of each force in that
/// direction, N. Both lists have the same length.
struct AxisForces {
  std::vector<double> displacements, forces;

  void add(double displacement, double force);
};

/// Interpolated and exact forces along a straight path from rest, or through rest.
struct ForceWay {
  std::string name;                                      ///< name shown to the user
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit
  AxisForces solved{};                                   ///< equilibria that the interpolations use
  AxisForces held_out{};                                 ///< exact solutions that they do not use
  std::vector<AxisForces> sampled{};  ///< one per interpolation; empty if the interpolation could
                                      ///< not be made
};

/// A point is on a path if it is at most this fraction of the ball's radius away from the path.
inline constexpr double on_way = 1e-6;

/// Returns the solved points of a space that lie on the path from rest along `direction`. With
/// `both`, the path also continues to the other side of rest.
AxisForces solvedOnWay(const SpaceTable& space, const Eigen::Vector3d& direction, bool both);

/// Like solvedOnWay(), for held-out solutions. radius: of the ball, m.
AxisForces heldOutOnWay(const std::vector<HeldOutSolution>& solutions, double radius,
                        const Eigen::Vector3d& direction, bool both);

/// Samples a force along `direction`, at displacements from `from` to `to`, m. force: returns the
/// force, N, at a displacement, m; NaN forces are kept.
AxisForces sampledOnWay(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& force,
                        const Eigen::Vector3d& direction, double from, double to);

/// Chooses up to three typical errors: the largest value, the 95th percentile and the median.
/// Returns their indices and names, each index once. Ignores values that are not finite.
std::vector<std::pair<std::size_t, const char*>> tellingOnes(const std::vector<double>& values);

}  // namespace palpate
