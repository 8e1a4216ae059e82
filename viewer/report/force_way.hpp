#pragma once

#include <functional>

#include "viewer/fields/force_field.hpp"
#include "viewer/report/held_out.hpp"

namespace palpate {

/// Displacements along one direction from rest, m, and the forces along the same direction there,
/// N; of equal length.
struct AxisForces {
  std::vector<double> displacements, forces;

  void add(double displacement, double force);
};

/// Forces of interpolations on a straight way from rest, and what is exact on it.
struct ForceWay {
  std::string name;                                      ///< for people
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< unit
  AxisForces solved{};                ///< equilibria that the interpolations are made from
  AxisForces held_out{};              ///< exact solutions that they have not seen
  std::vector<AxisForces> sampled{};  ///< one per interpolation; empty where there is none
};

/// Nearer to the way than this share of the radius a point lies on it.
inline constexpr double on_way = 1e-6;

/// Of the solved points of a space those on the way from rest along `direction`, on both sides of
/// rest where `both`.
AxisForces solvedOnWay(const SpaceTable& space, const Eigen::Vector3d& direction, bool both);

/// The same of exact solutions; `radius` of the ball, m.
AxisForces heldOutOnWay(const std::vector<HeldOutSolution>& solutions, double radius,
                        const Eigen::Vector3d& direction, bool both);

/// What `force` (N, of a displacement in m) says from displacement `from` to `to`, m. NaN where it
/// says NaN.
AxisForces sampledOnWay(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& force,
                        const Eigen::Vector3d& direction, double from, double to);

/// Numbers of the values that are the largest, at 95 % and the median; fewer where they are the
/// same. Values that are not finite do not count.
std::vector<std::pair<std::size_t, const char*>> tellingOnes(const std::vector<double>& values);

}  // namespace palpate
