#include "viewer/fields/live_correction.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/assertion.hpp"
#include "viewer/fields/wendland.hpp"

namespace palpate {
namespace {

/// Distance in s or in p at which the influence of an expansion ends, in finger radii.
constexpr double reach_radii = 1;
/// Step of the hold's place or displacement that makes it another hold, in reaches.
constexpr double hold_jump = 0.25;
/// b, the weight of the area's energy. An expansion weighs at most 1, and 0.005 at half of its
/// reach.
constexpr double area_weight = 1e-4;
/// Added to the squared distance in a weight, in squared reaches, so that the weight stays finite.
constexpr double softening = 0.05;
/// Factors of the error bound, so that it holds for 99 % of touches (tests/measure/bench/live_run).
/// One multiplies the disagreement of the expansions, the other their last terms times the distance
/// in reaches.
constexpr double disagreement_factor = 2, remainder_factor = 2.5;
constexpr double share_at_jump = 0.2;  ///< least distance for the latter without third derivatives
/// Share of the reach in which the stiffness of no smooth tissue doubles: on 16 bodies without
/// fibres, in 99 % of their points it takes more than 0.025 to 0.8 reaches.
constexpr double no_doubling_within = 0.03;
/// N, bound up to which a force counts as known, however small it is.
constexpr double known_within = 0.02;
/// Relative error of the live solver's force (TransitionSolver::follow).
constexpr double solver_error = 1e-4;
/// The same with fibres: 99 % of touches beside an equilibrium of the gallery's muscle are within
/// it.
constexpr double error_with_fibers = 0.02;

/// Returns the estimated error of one expansion, N. distance: in reaches.
double errorOf(double disagreement, double distance, double last_terms) {
  return disagreement_factor * disagreement + remainder_factor * distance * last_terms;
}

/// Returns the distance for errorOf(). Beside a jump of the stiffness, where an expansion has no
/// third derivatives, the error is a share of the last terms however near they are.
double growthOf(const Expansion& expansion, double distance) {
  return expansion.equilibrium.stiffness_by_p.isZero(0) ? std::max(distance, share_at_jump)
                                                        : distance;
}

/// Returns the squared distance of two holds.
double squaredDistance(const Hold& a, const Hold& b) {
  return (a.place - b.place).squaredNorm() + (a.displacement - b.displacement).squaredNorm();
}

}  // namespace

LiveCorrection::LiveCorrection(double finger_radius, bool has_fibers)
    : reach_(reach_radii * finger_radius),
      own_error_(has_fibers ? error_with_fibers : solver_error) {
  PALPATE_ASSERT(finger_radius > 0, "a finger must have a radius");
}

void LiveCorrection::add(const Expansion& expansion, double seconds) noexcept {
  const bool is_for_hold = isForHold(expansion),
             is_alone = now_.size == 0 || !now_.is_for_hold || !is_for_hold;
  Pair next = {{expansion, now_.expansions[0]}, is_alone ? 1u : 2u, is_for_hold};
  next.expansions[0].dropMeaningless(no_doubling_within * reach_);
  if (level_ >= 1) {
    before_ = now_;
    level_ = 0;
    rate_ = 1 / std::max(seconds, 1e-6);
  }
  now_ = next;
}

void LiveCorrection::advance(double seconds) noexcept {
  level_ = std::min(level_ + rate_ * seconds, 1.0);
}

void LiveCorrection::release(double seconds) noexcept {
  before_ = std::exchange(now_, {});
  level_ = 0;
  rate_ = 1 / seconds;
}

void LiveCorrection::setHold(const std::optional<Hold>& hold) noexcept {
  const bool is_same =
      hold.has_value() == hold_.has_value() &&
      (!hold || squaredDistance(*hold, *hold_) < hold_jump * hold_jump * reach_ * reach_);
  if (!is_same) before_.is_for_hold = now_.is_for_hold = false;
  hold_ = hold;
}

bool LiveCorrection::isForHold(const Expansion& expansion) const noexcept {
  if (!hold_ || !expansion.held) return !hold_ && !expansion.held;
  return squaredDistance(*hold_, expansion.held->at) < reach_ * reach_;
}

/// Returns the weight of an expansion at (s, p), with the hold at `hold` if one is given.
LiveCorrection::Weight LiveCorrection::weightOf(const Expansion& expansion,
                                                const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                                                const std::optional<Hold>& hold) const noexcept {
  const Eigen::Vector3d ds = (s - expansion.place) / reach_,
                        dp = (p - expansion.displacement) / reach_;
  double squared = ds.squaredNorm() + dp.squaredNorm();
  if (hold) squared += squaredDistance(*hold, expansion.held->at) / (reach_ * reach_);
  if (!(squared < 1)) return {};
  const Wendland ending(std::sqrt(squared));
  const double near = squared + softening, factor = softening * softening / (near * near);
  const double by_squared = factor * (0.5 * ending.slope_over_x - 2 * ending.value / near);
  return {factor * ending.value, std::sqrt(squared), 2 * by_squared / reach_ * ds,
          2 * by_squared / reach_ * dp};
}

HoldForce LiveCorrection::holdForce(const Eigen::Vector3d& s,
                                    const Eigen::Vector3d& p) const noexcept {
  if (!hold_ || !now_.is_for_hold) return {};
  std::array<Weight, 2> weights;
  std::array<Expansion::Sample, 2> samples;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  double sum = 0;
  for (std::size_t n = 0; n < now_.size; ++n) {
    weights[n] = weightOf(now_.expansions[n], s, p, hold_);
    samples[n] = now_.expansions[n].at(s, p, hold_);
    force += weights[n].value * samples[n].hold_force;
    sum += weights[n].value;
  }
  if (!(sum > 0)) return {};
  HoldForce found = {force / sum, own_error_ * force.norm() / sum};
  for (std::size_t n = 0; n < now_.size; ++n)
    found.error_bound += weights[n].value / sum *
                         errorOf((samples[n].hold_force - found.force).norm(), weights[n].distance,
                                 samples[n].hold_last_terms);
  return found;
}

double LiveCorrection::correct(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                               AreaSample& sample) const noexcept {
  if (hold_) {
    sample.error_bound = std::max(sample.error_bound, sample.force.norm());
    sample.inside = false;
  }
  const AreaSample area = sample;
  const double share = blend(now_, s, p, sample);
  if (level_ >= 1) return share;
  AreaSample from = area;
  const double share_before = blend(before_, s, p, from);
  // The weights change smoothly at both ends of the fade.
  const double now = level_ * level_ * (3 - 2 * level_), before = 1 - now;
  const double difference = (sample.force - from.force).norm();
  sample.error_bound = now * sample.error_bound + before * std::max(from.error_bound, difference);
  sample.energy = now * sample.energy + before * from.energy;
  sample.force = now * sample.force + before * from.force;
  sample.drive = now * sample.drive + before * from.drive;
  sample.stiffness = now * sample.stiffness + before * from.stiffness;
  if (before > now) {
    sample.inside = from.inside;
    sample.beyond = from.beyond;
    sample.coverage = from.coverage;
  }
  return now * share + before * share_before;
}

/// Does what correct() does, with a single pair of expansions.
double LiveCorrection::blend(const Pair& pair, const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                             AreaSample& sample) const noexcept {
  std::array<Weight, 2> weights;
  std::array<Expansion::Sample, 2> samples;
  const std::optional<Hold> hold = pair.is_for_hold ? hold_ : std::nullopt;
  double sum = area_weight, energy = area_weight * sample.energy;
  for (std::size_t n = 0; n < pair.size; ++n) {
    weights[n] = weightOf(pair.expansions[n], s, p, hold);
    samples[n] = pair.expansions[n].at(s, p, hold);
    sum += weights[n].value;
    energy += weights[n].value * samples[n].energy;
  }
  energy /= sum;
  if (sum == area_weight || !std::isfinite(energy)) return 0;
  AreaSample blended = sample;
  blended.energy = energy;
  blended.force *= area_weight;
  blended.drive *= area_weight;
  blended.stiffness *= area_weight;
  for (std::size_t n = 0; n < pair.size; ++n) {
    const double excess = samples[n].energy - energy;
    blended.force += weights[n].value * samples[n].force - excess * weights[n].by_p;
    blended.drive += weights[n].value * samples[n].drive - excess * weights[n].by_s;
    blended.stiffness += weights[n].value * pair.expansions[n].equilibrium.stiffness;
  }
  blended.force /= sum;
  blended.drive /= sum;
  blended.stiffness /= sum;
  const double share = 1 - area_weight / sum;
  blended.error_bound =
      (1 - share) * sample.error_bound + share * own_error_ * blended.force.norm();
  for (std::size_t n = 0; n < pair.size; ++n)
    blended.error_bound +=
        weights[n].value / sum *
        errorOf((samples[n].force - blended.force).norm(),
                growthOf(pair.expansions[n], weights[n].distance), samples[n].last_terms);
  if (pair.size > 0 && !pair.is_for_hold)
    blended.error_bound = std::max(blended.error_bound, blended.force.norm());
  if (share > 0.5) {
    blended.inside = blended.error_bound < std::max(blended.force.norm(), known_within);
    blended.beyond = 0;
  }
  blended.coverage = std::max(sample.coverage, share);
  sample = blended;
  return share;
}

}  // namespace palpate
