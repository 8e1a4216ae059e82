#pragma once

#include <limits>
#include <string_view>

#include "common/space/space_table.hpp"

namespace palpate {

/// What a force field says about one displacement. force and stiffness are always finite.
struct ForceSample {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, of the tissue on the tool
  /// N/m, [a, b] = d force_a / d displacement_b of exactly this interpolant; beyond the region that
  /// was computed its leading terms.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  double energy = std::numeric_limits<double>::quiet_NaN();  ///< J; NaN when the method has none
  /// N, on |force|; NaN when the method gives none.
  double error_bound = std::numeric_limits<double>::quiet_NaN();
  /// Share of the answer that stands on solved corners of the cell around, whose edges are all
  /// consistent (branch_check.hpp), by tri-linear weights: 1 where all eight are, 0 where
  /// everything is extrapolated.
  double coverage = 0;
  /// The displacement is in the region that was computed (answered_region.hpp), and a corner of the
  /// cell around it is solved. When false beyond that region, the sample is its continuation, which
  /// only stiffens and is no answer; the error bound grows with it. Not finite: no force.
  bool inside = false;
  double beyond = 0;  ///< m, along the displacement, beyond the edge of that region; 0 in it

  /// m, of a displacement that was answered with this: what lies beyond the edge. Shapes leave it
  /// out.
  Eigen::Vector3d excessOf(const Eigen::Vector3d& displacement) const noexcept {
    return beyond > 0 ? Eigen::Vector3d(displacement * (beyond / displacement.norm()))
                      : Eigen::Vector3d::Zero();
  }
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
