#pragma once

#include <limits>
#include <string_view>

#include "common/space/space_table.hpp"

namespace palpate {

/// Sample of a force field at one displacement. force and stiffness are always finite.
struct ForceSample {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, of the tissue on the tool
  /// N/m, [a, b] = d force_a / d displacement_b, the exact derivative of this interpolant; beyond
  /// the solved region only its leading terms.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< J; NaN if the method has none
  /// N, bound on |force error|; NaN if the method gives none.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
  /// Share of the interpolation that rests on solved corners with consistent edges only
  /// (branch_check.hpp), by tri-linear weights in the cell. 1 if all eight corners are such, 0 if
  /// everything is extrapolated.
  double coverage = 0;
  /// Whether the displacement is in the solved region (answered_region.hpp) and a corner of the
  /// cell around it is solved. Beyond that region the sample is a continuation, which only stiffens
  /// and is not reliable; the error bound grows with it. A NaN gives false and zero force.
  bool inside = false;
  double beyond = 0;  ///< m, length beyond the edge of that region, along the displacement; 0 in it

  /// Returns the part of a displacement, m, that lies beyond the edge; the sample must be the one
  /// at this displacement. Shapes are evaluated without it.
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
