#pragma once

#include <limits>
#include <string_view>

#include "common/space/space_table.hpp"

namespace palpate {

/// Sample of a force field at one displacement. force and stiffness are always finite.
struct ForceSample {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, of the tissue on the tool
  /// N/m, [a, b] = d force_a / d displacement_b. The exact derivative of `force` in the answered
  /// region; beyond the region, only the leading terms of the derivative.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< J; NaN if the method has none
  /// N, bound on |force error|; NaN if the method gives none.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
  /// Sum of the tri-linear weights of the reliable corners of the cell around the displacement,
  /// 0..1. A corner is reliable if it is solved and all its edges are consistent
  /// (branch_check.hpp). 1 if all eight corners are reliable, 0 if everything is extrapolated.
  double coverage = 0;
  /// Whether the displacement is in the answered region (answered_region.hpp) and a corner of the
  /// cell around it is solved. Beyond the region the sample is a continuation: the force only gets
  /// stiffer and is not reliable, and the error bound grows with the added force. False for a NaN
  /// displacement, for which the force is zero.
  bool inside = false;
  double beyond = 0;  ///< m, length of the displacement's part beyond the answered region

  /// Returns the part of the sample's displacement, m, that lies beyond the answered region.
  /// `displacement` must be the one at which the sample was evaluated. Shapes are evaluated without
  /// that part.
  Eigen::Vector3d excessOf(const Eigen::Vector3d& displacement) const noexcept {
    return beyond > 0 ? Eigen::Vector3d(displacement * (beyond / displacement.norm()))
                      : Eigen::Vector3d::Zero();
  }
};

/// Interpolates one configuration space. The constructor copies and prepares everything, so the
/// dataset may be destroyed. Immutable: any number of threads may evaluate at the same time.
class ForceField {
 public:
  virtual ~ForceField() = default;
  /// Evaluates the field. displacement: of the active node from its rest position, metres, any
  /// value. Real time: does not allocate, lock, throw or log.
  virtual ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept = 0;
  /// Name of the method, as given to --method.
  virtual std::string_view name() const = 0;
};

}  // namespace palpate
