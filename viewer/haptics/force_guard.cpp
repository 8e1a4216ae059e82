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

/// False for NaN.
bool isUsable(const Eigen::Vector3d& values) {
  return (values.array().abs() <= EnergyLimit::largest_number).all();
}

/// 0 at 0, 1 at 1, flat at both.
double smoothStep(double t) { return t * t * (3 - 2 * t); }

/// Shortens to `longest`, keeping the direction; the rounding of later sums included.
bool shorten(Eigen::Vector3d& v, double longest) {
  const double length = v.norm();
  if (length <= longest) return false;
  v *= longest / length * (1 - 4 * std::numeric_limits<double>::epsilon());
  return true;
}

}  // namespace

GuardOptions guardFor(const DeviceProfile& profile, double period) {
  GuardOptions options;
  options.period = period;
  options.max_force = profile.max_force;
  options.max_stiffness = profile.max_stiffness;
  return options;
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

ForceGuard::ForceGuard(const GuardOptions& options)
    : options_(options), energy_(options.period, slewOf(options), options.energy_credit) {
  const auto require = [](const char* option, double value, bool holds, const char* what) {
    if (!(std::isfinite(value) && holds))
      throw badInput("force guard: {} = {} is not {}; give a device profile", option, value, what);
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
  reset();
}

void ForceGuard::reset() noexcept {
  energy_.reset();
  given_ = offset_ = tool_ = Eigen::Vector3d::Zero();
  ramp_time_ = options_.ramp;
  usable_ = stalled_ = false;
  ticks_since_fresh_ = 0;
}

/// From the force that the hand feels now: a force that was clamped, slewed or faded goes on from
/// there.
void ForceGuard::startRamp(const Eigen::Vector3d& raw) noexcept {
  offset_ = raw - given_;
  ramp_time_ = 0;
}

/// Whether there was no fresh reading for too long.
bool ForceGuard::countStale(bool fresh) noexcept {
  ticks_since_fresh_ = fresh ? 0 : ticks_since_fresh_ + 1;
  return static_cast<double>(ticks_since_fresh_) * options_.period > options_.stall;
}

/// Whether no hand is as fast. Before countStale(): since the last fresh reading.
bool ForceGuard::jumped(const GuardInput& input) const noexcept {
  const double time = static_cast<double>(ticks_since_fresh_ + 1) * options_.period;
  return (input.tool - tool_).norm() > options_.max_speed * time;
}

HeldForces ForceGuard::delayed(HeldForces held) const noexcept {
  const double ticks = options_.delay / options_.period;
  held.newest += static_cast<std::uint16_t>(std::floor(ticks));
  held.oldest += static_cast<std::uint16_t>(std::ceil(ticks));
  held.delay += options_.delay;
  return held;
}

/// What is left of the step, to be taken from the raw force.
Eigen::Vector3d ForceGuard::fade() noexcept {
  if (ramp_time_ >= options_.ramp) return Eigen::Vector3d::Zero();
  // Never s = 0: were every tick a step, the force would otherwise stay what it is.
  ramp_time_ += options_.period;
  return (1 - smoothStep(std::min(1.0, ramp_time_ / options_.ramp))) * offset_;
}

GuardedForce ForceGuard::limit(const GuardInput& input) noexcept {
  GuardedForce result;
  const auto tell = [&result](Guarded guarded, bool is) {
    if (is) result.guards |= static_cast<std::uint32_t>(guarded);
  };
  const bool usable = isUsable(input.tool) && isUsable(input.touch.force);
  tell(Guarded::not_finite, !usable && !input.lost && !input.away);
  tell(Guarded::lost, input.lost);
  tell(Guarded::late, input.late);
  tell(Guarded::beyond, input.touch.touching && !input.touch.inside);
  if (input.lost || input.late) {
    reset();
    return result;
  }

  const bool jump = usable && usable_ && jumped(input);
  const bool stalled = countStale(input.fresh);
  const bool stepped = input.touch.stepped || jump || usable != usable_ || (stalled_ && !stalled);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  if (usable) force = input.touch.force;
  const double length = force.norm();
  const double rendered = length > options_.max_force ? options_.max_force / length : 1;
  if (jump || !usable) energy_.forgetMotion();
  if (usable) {
    energy_.observe(input.tool, input.touch, rendered, delayed(input.held), input.fresh);
    if (input.fresh || !usable_) tool_ = input.tool;
  }
  usable_ = usable;
  stalled_ = stalled;
  tell(Guarded::stalled, stalled);

  if (stepped) startRamp(force);
  const Eigen::Vector3d faded = fade();
  force -= faded;
  tell(Guarded::ramped, !faded.isZero(0));
  tell(Guarded::clamped, shorten(force, options_.max_force));
  if (stepped || !faded.isZero(0))
    energy_.restart(input.touch.touching ? rendered * input.touch.energy : 0);
  else
    tell(Guarded::damped, energy_.bound(force, input.touch.stiffness));
  if (stalled) force.setZero();
  Eigen::Vector3d change = force - given_;
  const bool slewed = shorten(change, options_.max_slew * options_.period);
  tell(Guarded::slewed, slewed);
  if (slewed) force = given_ + change;

  given_ = force;
  energy_.give(force);
  result.force = force;
  result.passivity = energy_.passivity();
  return result;
}

}  // namespace palpate
