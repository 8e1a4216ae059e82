#pragma once

#include <limits>
#include <string_view>

#include "common/space/space_table.hpp"

namespace palpate {

/// What a force field says about one displacement. force and stiffness are always finite.
struct ForceSample {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, of the tissue on the tool
  /// N/m, [a, b] = d force_a / d displacement_b of exactly this interpolant.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< J; NaN when the method has none
  /// N, on |force|; NaN when the method gives none.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
  /// Share of the answer that stands on solved corners of the cell around, whose edges are all
  /// consistent (branch_check.hpp), by tri-linear weights: 1 where all eight are, 0 where
  /// everything is extrapolated.
  double coverage = 0;
  /// The displacement is in the closed workspace ball, and a corner of the cell around it is
  /// solved. When false outside of the ball, the force is that at the nearest point of the sphere,
  /// and the error bound grows with the distance: something a client can fade out from, not an
  /// answer. Not finite: no force.
  bool inside = false;
};

/// Interpolates one configuration space. Everything is prepared in the constructor and copied: the
/// dataset may go. Immutable: any number of threads may evaluate at once.
class ForceField {
 public:
  virtual ~ForceField() = default;
  /// displacement: of the active node from its rest position, metres, any value.
  /// Real time: does not allocate, lock, throw or log.
  virtual ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept = 0;
  /// The word for --method.
  virtual std::string_view name() const = 0;
};

}  // namespace palpate
