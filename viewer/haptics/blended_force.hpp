#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "viewer/haptics/haptic_model.hpp"

namespace palpate {

class LiveTouch;

/// Derivatives of the contact energy W(X) = sum w_i(X) E_i(tool - X) and of the force F (Contact),
/// for an anchor X that moves within one triangle.
struct AnchorSlope {
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();  ///< dW/dX, N, in the plane of the triangle
  /// d2W/dX2, N/m; only the part in the plane of the triangle is meaningful
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d change = Eigen::Matrix3d::Zero();  ///< dF/dX, N/m
};

/// The force at an anchor: computed from the energy of the area that contains the anchor, or,
/// outside of areas, blended from the spaces around the anchor. Each space is evaluated at most
/// once for one displacement.
class BlendedForce {
 public:
  /// `live` corrects the areas of `live_model` (ContactOptions); null: no correction.
  explicit BlendedForce(const LiveTouch* live = nullptr, const HapticModel* live_model = nullptr)
      : live_(live), live_model_(live_model) {}

  /// Sets the model whose areas are corrected, as in the constructor.
  void correct(const HapticModel* live_model) { live_model_ = live_model; }

  /// anchor: in a touchable triangle. displacement: m. The model must outlive later calls of
  /// slopeAlong().
  void evaluate(const HapticModel& model, std::size_t method, const SurfacePoint& anchor,
                const Eigen::Vector3d& displacement) noexcept;
  /// The same in two parts, for callers that need the error bound of few forces. The first may
  /// leave error_bound, coverage and `inside` of sum() to judge().
  void evaluateUnjudged(const HapticModel& model, std::size_t method, const SurfacePoint& anchor,
                        const Eigen::Vector3d& displacement) noexcept;
  void judge() noexcept;

  const SpaceBlend& blend() const { return blend_; }
  const Eigen::Vector3d& force() const { return sum_.force; }
  const Eigen::Matrix3d& stiffness() const { return sum_.stiffness; }
  /// Returns the sample of the anchor's area or, outside of areas, the weighted sums of the samples
  /// of the spaces. In a weighted sum, energy and error_bound are NaN if one space has none, inside
  /// is true if all samples are inside, and beyond is the largest of all samples.
  const ForceSample& sum() const { return sum_; }
  /// Returns the configurational force -dE/ds at the anchor, N; zero outside of areas.
  const Eigen::Vector3d& drive() const { return sum_.drive; }
  /// Returns the share of the live solver's equilibria in the force, 0 to 1.
  double followed() const { return followed_; }

  /// Returns the derivatives of W and F for an anchor that moves within `triangle`. The triangle
  /// must be touchable, contain the anchor or have it on its edge, and be in the same area as the
  /// anchor (or in no area, if the anchor is in none).
  ///
  /// In an area W(X) = E(X, tool - X) and dW/dX = F - T, where T is the configurational force.
  /// `change` and `hessian` leave out the derivative of T, because they only bound the length of a
  /// step. If a space has no energy, `tangent` contains only the force.
  AnchorSlope slopeAlong(std::int32_t triangle) noexcept;

 private:
  /// Largest number of spaces sampled at one displacement; about seven if every vertex is active.
  static constexpr std::size_t most_samples = 32;
  /// Returns the sample of a space at the current displacement; null if more than most_samples
  /// spaces were requested.
  const ForceSample* sampleOf(std::int32_t space) noexcept;

  const LiveTouch* live_;
  const HapticModel* live_model_;
  double followed_ = 0;
  const HapticModel* model_ = nullptr;
  std::size_t method_ = 0;
  Eigen::Vector3d displacement_ = Eigen::Vector3d::Zero();
  SpaceBlend blend_;
  std::int32_t area_ = -1;                           ///< of the anchor; -1: none
  Eigen::Vector3d place_ = Eigen::Vector3d::Zero();  ///< m, of the anchor, if it is in an area
  AreaSample sum_;
  std::array<std::int32_t, most_samples> spaces_{};
  std::array<ForceSample, most_samples> samples_;
  std::size_t size_ = 0;
};

}  // namespace palpate
