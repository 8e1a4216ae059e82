#include "viewer/fields/live_correction.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "viewer/fields/wendland.hpp"

namespace palpate {
namespace {

/// Distance in s or in p at which the influence of an expansion ends, in finger radii.
constexpr double reach_radii = 1;
/// b, the weight of the area's energy. An expansion whose distance is half of its reach weighs 2.
constexpr double area_weight = 0.01;
/// Softens the weights near an expansion, in squared reaches.
constexpr double softening = 0.05;
/// Number of expansions that stay visible after a newer one was added.
constexpr std::size_t kept = 2;
/// Factors of the error bound, for 99 % of touches (tests/measure/bench/live_run): of the
/// disagreement of the expansions, and of their last terms times the distance in reaches.
constexpr double disagreement_factor = 2, remainder_factor = 2.5;
/// Relative error of a follower's equilibrium itself (TransitionSolver::follow).
constexpr double solver_error = 1e-4;

}  // namespace

LiveCorrection::LiveCorrection(double finger_radius) : reach_(reach_radii * finger_radius) {
  PALPATE_ASSERT(finger_radius > 0, "a finger has a size");
}

void LiveCorrection::add(const Expansion& expansion) noexcept {
  const auto less_needed = [](const Slot& a, const Slot& b) {
    return a.level != b.level ? a.level < b.level : a.number < b.number;
  };
  Slot& slot = *std::ranges::min_element(slots_, less_needed);
  slot = {expansion, 0, true, ++count_};
  for (Slot& other : slots_) other.rises = other.rises && other.number + kept > count_;
}

void LiveCorrection::advance(double seconds) noexcept {
  const double step = seconds / fade;
  for (Slot& slot : slots_)
    slot.level = std::clamp(slot.level + (slot.rises ? step : -step), 0., 1.);
}

void LiveCorrection::release() noexcept {
  for (Slot& slot : slots_) slot.rises = false;
}

LiveCorrection::Weight LiveCorrection::weightOf(const Slot& slot, const Eigen::Vector3d& s,
                                                const Eigen::Vector3d& p) const noexcept {
  const Eigen::Vector3d ds = (s - slot.expansion.place) / reach_,
                        dp = (p - slot.expansion.displacement) / reach_;
  const double squared = ds.squaredNorm() + dp.squaredNorm();
  if (!(squared < 1) || slot.level == 0) return {};
  // Smooth at both ends of a fade.
  const double level = slot.level * slot.level * (3 - 2 * slot.level);
  const Wendland ending(std::sqrt(squared));
  const double near = squared + softening, factor = level / (near * near);
  const double by_squared = factor * (0.5 * ending.slope_over_x - 2 * ending.value / near);
  return {factor * ending.value, std::sqrt(squared), 2 * by_squared / reach_ * ds,
          2 * by_squared / reach_ * dp};
}

double LiveCorrection::correct(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                               AreaSample& sample) const noexcept {
  std::array<Weight, most> weights;
  std::array<Expansion::Sample, most> samples;
  double sum = area_weight, energy = area_weight * sample.energy;
  for (std::size_t n = 0; n < most; ++n) {
    weights[n] = weightOf(slots_[n], s, p);
    if (weights[n].value == 0) continue;
    samples[n] = slots_[n].expansion.at(s, p);
    sum += weights[n].value;
    energy += weights[n].value * samples[n].energy;
  }
  if (sum == area_weight || !std::isfinite(energy)) return 0;
  energy /= sum;
  AreaSample blend = sample;
  blend.energy = energy;
  blend.force *= area_weight;
  blend.drive *= area_weight;
  blend.stiffness *= area_weight;
  for (std::size_t n = 0; n < most; ++n) {
    const Weight& weight = weights[n];
    if (weight.value == 0) continue;
    const double excess = samples[n].energy - energy;
    blend.force += weight.value * samples[n].force - excess * weight.by_p;
    blend.drive += weight.value * samples[n].drive - excess * weight.by_s;
    blend.stiffness += weight.value * slots_[n].expansion.equilibrium.stiffness;
  }
  blend.force /= sum;
  blend.drive /= sum;
  blend.stiffness /= sum;
  const double share = 1 - area_weight / sum;
  blend.error_bound = (1 - share) * sample.error_bound + share * solver_error * blend.force.norm();
  for (std::size_t n = 0; n < most; ++n)
    if (weights[n].value > 0)
      blend.error_bound += weights[n].value / sum *
                           (disagreement_factor * (samples[n].force - blend.force).norm() +
                            remainder_factor * weights[n].distance * samples[n].last_terms);
  if (share > 0.5) {
    blend.inside = true;
    blend.beyond = 0;
  }
  blend.coverage = std::max(sample.coverage, share);
  sample = blend;
  return share;
}

}  // namespace palpate
