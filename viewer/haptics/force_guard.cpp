#include "viewer/haptics/force_guard.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

/// Returns false also for NaN.
bool isUsable(const Eigen::Vector3d& values) {
  return (values.array().abs() <= EnergyLimit::largest_number).all();
}

std::uint32_t bitIf(Guarded guarded, bool is) {
  return is ? static_cast<std::uint32_t>(guarded) : 0;
}

/// Shortens a vector to `longest` and keeps its direction. The result is slightly shorter than
/// `longest`, so that sums computed from it cannot exceed the limit by rounding. Returns whether
/// the vector was shortened.
bool shorten(Eigen::Vector3d& v, double longest) {
  const double length = v.norm();
  if (length <= longest) return false;
  v *= longest / length * (1 - 4 * std::numeric_limits<double>::epsilon());
  return true;
}

}  // namespace

GuardOptions guardFor(const DeviceProfile& profile, double period) {
  return {.period = period, .max_force = profile.max_force, .max_stiffness = profile.max_stiffness};
}

double slewOf(const GuardOptions& options) {
  constexpr double shortest_rise = 0.01;  // s
  return options.max_slew > 0 ? options.max_slew : options.max_force / shortest_rise;
}

const char* guardWord(int bit) {
  constexpr std::array<const char*, guard_count> words = {
      "ramped", "damped", "clamped", "slewed", "stalled", "lost", "not_finite", "late", "beyond"};
  return bit >= 0 && bit < guard_count ? words[at(bit)] : "";
}

Eigen::Vector3d ForceRamp::next() noexcept {
  if (time_ >= duration_) return Eigen::Vector3d::Zero();
  // Advance the time first. If every tick began a new step, the force would otherwise never change.
  time_ += period_;
  const double t = std::min(1.0, time_ / duration_);
  return (1 - t * t * (3 - 2 * t)) * step_;
}

ForceGuard::ForceGuard(const GuardOptions& options)
    : options_(options),
      ramp_(options.period, options.ramp),
      energy_(options.period, slewOf(options), options.energy_credit) {
  const auto require = [](const char* option, double value, bool holds, const char* what) {
    if (!(std::isfinite(value) && holds))
      throw badInput("force guard: {} = {} is not {}; check the device profile", option, value,
                     what);
  };
  for (const auto& [option, value] :
       {std::pair("period", options.period), std::pair("max_force", options.max_force),
        std::pair("max_speed", options.max_speed)})
    require(option, value, value > 0, "a positive number");
  for (const auto& [option, value] :
       {std::pair("max_slew", options.max_slew), std::pair("ramp", options.ramp),
        std::pair("stall", options.stall), std::pair("max_stiffness", options.max_stiffness),
        std::pair("energy_credit", options.energy_credit), std::pair("delay", options.delay)})
    require(option, value, value >= 0, "a number >= 0");
  require("delay", options.delay, options.delay <= (EnergyLimit::remembered - 2) * options.period,
          "at most 30 periods");
  options_.max_slew = slewOf(options);
}

void ForceGuard::reset() noexcept {
  energy_.reset();
  ramp_.reset();
  given_ = tool_ = Eigen::Vector3d::Zero();
  usable_ = stalled_ = false;
  ticks_since_fresh_ = 0;
}

HeldForces ForceGuard::delayed(HeldForces held) const noexcept {
  const double ticks = options_.delay / options_.period;
  held.newest += static_cast<std::uint16_t>(std::floor(ticks));
  held.oldest += static_cast<std::uint16_t>(std::ceil(ticks));
  held.delay += options_.delay;
  return held;
}

/// Returns the fraction of a raw force that remains after the clamp to max_force.
double ForceGuard::renderedShare(const Eigen::Vector3d& raw) const noexcept {
  const double length = raw.norm();
  return length > options_.max_force ? options_.max_force / length : 1;
}

/// Records the position of the tool. Returns whether the raw force makes a step from the last tick
/// to this one.
bool ForceGuard::takeIn(const GuardInput& input, bool usable) noexcept {
  const double since_fresh = static_cast<double>(ticks_since_fresh_ + 1) * options_.period;
  const bool jump =
      usable && usable_ && (input.tool - tool_).norm() > options_.max_speed * since_fresh;
  ticks_since_fresh_ = input.fresh ? 0 : ticks_since_fresh_ + 1;
  const bool was_stalled = stalled_, was_usable = usable_;
  stalled_ = static_cast<double>(ticks_since_fresh_) * options_.period > options_.stall;
  usable_ = usable;
  if (jump || !usable) energy_.forgetMotion();
  if (usable) {
    energy_.observe(input.tool, input.touch, renderedShare(input.touch.force), delayed(input.held),
                    input.fresh);
    if (input.fresh || !was_usable) tool_ = input.tool;
  }
  return input.touch.stepped || jump || usable != was_usable || (was_stalled && !stalled_);
}

/// Returns the rendered force for a raw force, N. Applies steps 2 to 6 of the class comment.
Eigen::Vector3d ForceGuard::shaped(const Eigen::Vector3d& raw, const Touch& touch, bool stepped,
                                   std::uint32_t& guards) noexcept {
  // The step begins at the force that the hand feels now, even if that force was clamped, slewed or
  // faded.
  if (stepped) ramp_.begin(raw - given_);
  const Eigen::Vector3d faded = ramp_.next();
  const bool ramped = !faded.isZero(0);
  Eigen::Vector3d force = raw - faded;
  guards |= bitIf(Guarded::ramped, ramped);
  guards |= bitIf(Guarded::clamped, shorten(force, options_.max_force));
  if (stepped || ramped)
    energy_.restart(touch.touching ? renderedShare(raw) * touch.energy : 0);
  else
    guards |= bitIf(Guarded::damped, energy_.bound(force, touch.stiffness));
  if (stalled_) force.setZero();
  Eigen::Vector3d change = force - given_;
  if (!shorten(change, options_.max_slew * options_.period)) return force;
  guards |= bitIf(Guarded::slewed, true);
  return given_ + change;
}

GuardedForce ForceGuard::limit(const GuardInput& input) noexcept {
  GuardedForce result;
  result.guards = bitIf(Guarded::lost, input.lost) | bitIf(Guarded::late, input.late) |
                  bitIf(Guarded::beyond, input.touch.touching && !input.touch.inside);
  const bool usable = isUsable(input.tool) && isUsable(input.touch.force);
  result.guards |= bitIf(Guarded::not_finite, !usable && !input.lost && !input.away);
  if (input.lost || input.late) {
    reset();
    return result;
  }
  const bool stepped = takeIn(input, usable);
  result.guards |= bitIf(Guarded::stalled, stalled_);
  const Eigen::Vector3d raw = usable ? input.touch.force : Eigen::Vector3d::Zero().eval();
  given_ = result.force = shaped(raw, input.touch, stepped, result.guards);
  energy_.give(given_);
  result.passivity = energy_.passivity();
  return result;
}

}  // namespace palpate
