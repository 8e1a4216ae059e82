#include "viewer/haptics/blended_force.hpp"

#include <algorithm>
#include <cmath>

#include "viewer/haptics/live_touch.hpp"

namespace palpate {

void BlendedForce::evaluate(const HapticModel& model, std::size_t method,
                            const SurfacePoint& anchor,
                            const Eigen::Vector3d& displacement) noexcept {
  evaluateUnjudged(model, method, anchor, displacement);
  judge();
}

void BlendedForce::evaluateUnjudged(const HapticModel& model, std::size_t method,
                                    const SurfacePoint& anchor,
                                    const Eigen::Vector3d& displacement) noexcept {
  model_ = &model;
  method_ = method;
  displacement_ = displacement;
  size_ = 0;
  followed_ = 0;
  blend_ = model.surface().blendAt(anchor);
  area_ = model.surface().areaOf(anchor.triangle);
  if (area_ >= 0) {
    place_ = model.surface().position(anchor);
    sum_ = model.area(at(area_)).evaluateUnjudged(place_, displacement);
    if (model.isGuessAt(place_)) {
      judge();
      // In this order, a bound that is NaN becomes the force.
      sum_.error_bound = std::max(sum_.force.norm(), sum_.error_bound);
      sum_.inside = false;
      sum_.coverage = 0;
    }
    if (live_ != nullptr && &model == live_model_) {
      judge();
      followed_ = live_->correct(place_, displacement, sum_);
    }
    return;
  }
  sum_ = {};
  sum_.energy = sum_.error_bound = 0;
  sum_.inside = true;
  for (const auto& [space, weight] : blend_.used()) {
    const ForceSample* const sample = sampleOf(space);
    if (sample == nullptr) continue;  // impossible: a triangle has fewer spaces than most_samples
    sum_.force += weight * sample->force;
    sum_.stiffness += weight * sample->stiffness;
    sum_.energy += weight * sample->energy;
    sum_.error_bound += weight * sample->error_bound;
    sum_.coverage += weight * sample->coverage;
    sum_.inside = sum_.inside && sample->inside;
    sum_.beyond = std::max(sum_.beyond, sample->beyond);
  }
}

void BlendedForce::judge() noexcept {
  if (area_ >= 0) model_->area(at(area_)).judge(place_, displacement_, sum_);
}

AnchorSlope BlendedForce::slopeAlong(std::int32_t triangle) noexcept {
  const TouchSurface& surface = model_->surface();
  const Eigen::Vector3d& normal = surface.faceNormal(triangle);
  if (surface.areaOf(triangle) >= 0) {
    const Eigen::Vector3d total = sum_.force - sum_.drive;
    return {total - normal.dot(total) * normal, -sum_.stiffness, -sum_.stiffness};
  }
  Eigen::Vector3d of_energies = Eigen::Vector3d::Zero();
  Eigen::Matrix3d of_weights = Eigen::Matrix3d::Zero();
  bool has_energies = std::isfinite(sum_.energy);
  for (const CornerShares& corners : surface.cornerSharesOf(triangle)) {
    const Eigen::Vector3d& weights = corners.weights;
    if (weights[0] == weights[1] && weights[1] == weights[2]) continue;
    const Eigen::Vector3d gradient = surface.barycentricGradients(triangle) * weights;
    const ForceSample* const sample = sampleOf(corners.space);
    if (sample == nullptr || !std::isfinite(sample->energy)) has_energies = false;
    if (sample == nullptr) continue;
    of_energies += sample->energy * gradient;
    of_weights += sample->force * gradient.transpose();
  }
  AnchorSlope slope;
  const Eigen::Vector3d total =
      has_energies ? Eigen::Vector3d(sum_.force + of_energies) : sum_.force;
  slope.tangent = total - normal.dot(total) * normal;
  slope.change = of_weights - sum_.stiffness;
  slope.hessian = slope.change;
  if (has_energies) slope.hessian += of_weights.transpose();
  return slope;
}

const ForceSample* BlendedForce::sampleOf(std::int32_t space) noexcept {
  for (std::size_t n = 0; n < size_; ++n)
    if (spaces_[n] == space) return &samples_[n];
  if (size_ == most_samples) return nullptr;
  spaces_[size_] = space;
  samples_[size_] = model_->field(method_, static_cast<std::size_t>(space)).evaluate(displacement_);
  return &samples_[size_++];
}

}  // namespace palpate
