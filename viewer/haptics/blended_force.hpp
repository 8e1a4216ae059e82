#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

/// How the stored energy W(X) = sum w_i(X) E_i(tool - X) of a contact, and its force, change when
/// the anchor X moves along one triangle.
struct AnchorSlope {
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();  ///< N, dW/dX, in the plane of the triangle
  /// N/m, d2W/dX2; its part in the plane means something
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d change = Eigen::Matrix3d::Zero();  ///< N/m, dF/dX
};

/// The force of the area that an anchor lies in, or of the spaces around it. Every space is asked
/// once per displacement.
/// One thread; real time: nothing here allocates, locks, throws or logs.
class BlendedForce {
 public:
  /// anchor: in a touchable triangle. displacement: m. The model must outlive the use of this
  /// object.
  void evaluate(const HapticModel& model, std::size_t method, const SurfacePoint& anchor,
                const Eigen::Vector3d& displacement) noexcept;

  const SpaceBlend& blend() const { return blend_; }
  const Eigen::Vector3d& force() const { return sum_.force; }
  const Eigen::Matrix3d& stiffness() const { return sum_.stiffness; }
  /// Sums by weight; energy and bound are NaN where one space has none; inside: all are; beyond:
  /// the largest.
  const ForceSample& sum() const { return sum_; }

  /// For a touchable triangle that the anchor lies in or at the edge of, in the same area or none.
  /// In an area W(X) = E(X, tool - X), dW/dX = F - T; what T changes by is left out of `change` and
  /// `hessian`, which only tell how long a step may be. Where a space has no
  /// energy the tangent is that of the force alone.
  AnchorSlope slopeAlong(std::int32_t triangle) noexcept;

 private:
  /// Around a vertex of a surface of which every vertex is active there are seven or so.
  static constexpr std::size_t most_samples = 32;
  /// Null when more than most_samples were asked for.
  const ForceSample* sampleOf(std::int32_t space) noexcept;

  const HapticModel* model_ = nullptr;
  std::size_t method_ = 0;
  Eigen::Vector3d displacement_ = Eigen::Vector3d::Zero();
  SpaceBlend blend_;
  ForceSample sum_;
  Eigen::Vector3d drive_ = Eigen::Vector3d::Zero();  ///< N, of an area
  std::array<std::int32_t, most_samples> spaces_{};
  std::array<ForceSample, most_samples> samples_;
  std::size_t size_ = 0;
};

}  // namespace palpate
