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

/// Nothing a hand can feel or reach; squares and sums of such numbers do not overflow.
constexpr double largest_number = 1e9;

/// False for NaN.
bool isUsable(double value) { return std::abs(value) <= largest_number; }
template <class Derived>
bool isUsable(const Eigen::MatrixBase<Derived>& values) {
  return (values.array().abs() <= largest_number).all();
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
  options.max_slew = profile.max_force / 0.01;
  options.max_stiffness = profile.max_stiffness;
  return options;
}

const char* guardWord(int bit) {
  constexpr std::array<const char*, guard_count> words = {
      "ramped", "damped", "clamped", "slewed", "stalled", "lost", "not_finite", "late"};
  return bit >= 0 && bit < guard_count ? words[at(bit)] : "";
}

ForceGuard::ForceGuard(const GuardOptions& options) : options_(options) {
  const auto require = [](const char* option, double value, bool holds, const char* what) {
    if (!(std::isfinite(value) && holds))
      throw badInput("force guard: {} = {} is not {}; give a device profile", option, value, what);
  };
  for (const auto& [option, value] :
       {std::pair("period", options.period), std::pair("max_force", options.max_force),
        std::pair("max_slew", options.max_slew)})
    require(option, value, value > 0, "a positive number");
  for (const auto& [option, value] :
       {std::pair("ramp", options.ramp), std::pair("stall", options.stall),
        std::pair("max_stiffness", options.max_stiffness),
        std::pair("energy_credit", options.energy_credit)})
    require(option, value, value >= 0, "a number >= 0");
  reset();
}

void ForceGuard::reset() noexcept {
  given_ = offset_ = tool_ = motion_ = Eigen::Vector3d::Zero();
  ramp_time_ = options_.ramp;
  usable_ = stalled_ = touching_ = false;
  ticks_since_fresh_ = 0;
  stored_ = passivity_ = 0;
  clamp_share_ = 1;
}

/// From the force that the hand feels now: a force that was clamped, slewed or faded goes on from
/// there.
void ForceGuard::startRamp(const Eigen::Vector3d& raw) noexcept {
  offset_ = raw - given_;
  ramp_time_ = 0;
  restartObserver();
}

void ForceGuard::restartObserver() noexcept {
  passivity_ = std::clamp(passivity_, -options_.energy_credit, options_.energy_credit);
}

/// The work of the tick that has just ended, in which given_ was held. Both ends of it count for
/// the share of the clamp, so that the way back gives what the way in took.
void ForceGuard::observe(const GuardInput& input, bool stepped) noexcept {
  const Touch& touch = input.touch;
  const double length = touch.force.norm();
  const double clamp_share = length > options_.max_force ? options_.max_force / length : 1;
  const double stored = touch.touching ? touch.energy : 0;
  motion_.setZero();
  if (usable_) motion_ = input.tool - tool_;
  if (touching_ || touch.touching) {
    passivity_ -= given_.dot(motion_);
    const double change = 0.5 * (clamp_share_ + clamp_share) * (stored - stored_);
    if (!stepped && isUsable(change)) passivity_ -= change;
    passivity_ = std::min(passivity_, options_.energy_credit);
  }
  if (touching_ && !touch.touching) restartObserver();
  tool_ = input.tool;
  touching_ = touch.touching;
  stored_ = stored;
  clamp_share_ = clamp_share;
}

void ForceGuard::forgetContact() noexcept {
  motion_.setZero();
  touching_ = false;
  stored_ = 0;
  clamp_share_ = 1;
}

/// - b v, with b v . v T = what is missing.
Eigen::Vector3d ForceGuard::damping(const Eigen::Matrix3d& stiffness) const noexcept {
  const double length = motion_.norm();
  if (!(passivity_ < 0) || !(length > 0) || !isUsable(stiffness)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d direction = motion_ / length;
  const double local = std::min((stiffness * direction).norm(), options_.max_stiffness);
  // b v = (missing / (v^2 T)) v with v = length / T
  return -std::min(-passivity_ / length, local * length) * direction;
}

/// Whether there was no fresh reading for too long.
bool ForceGuard::countStale(bool fresh) noexcept {
  ticks_since_fresh_ = fresh ? 0 : ticks_since_fresh_ + 1;
  return static_cast<double>(ticks_since_fresh_) * options_.period > options_.stall;
}

/// What is left of the step, to be taken from the raw force.
Eigen::Vector3d ForceGuard::fade() noexcept {
  if (ramp_time_ >= options_.ramp) return Eigen::Vector3d::Zero();
  // Never s = 0: were every tick a step, the force would otherwise stay what it is.
  ramp_time_ += options_.period;
  const double left = 1 - smoothStep(std::min(1.0, ramp_time_ / options_.ramp));
  if (left <= 0) restartObserver();
  return left * offset_;
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
  if (input.lost || input.late) {
    reset();
    return result;
  }

  const bool stalled = countStale(input.fresh);
  const bool stepped = input.touch.stepped || usable != usable_ || (stalled_ && !stalled);
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  if (usable) {
    force = input.touch.force;
    observe(input, stepped);
  } else {
    forgetContact();
  }
  usable_ = usable;
  stalled_ = stalled;
  tell(Guarded::stalled, stalled);

  if (stepped) startRamp(force);
  const Eigen::Vector3d faded = fade();
  force -= faded;
  tell(Guarded::ramped, !faded.isZero(0));
  if (touching_) {
    const Eigen::Vector3d damped = damping(input.touch.stiffness);
    force += damped;
    tell(Guarded::damped, !damped.isZero(0));
  }
  tell(Guarded::clamped, shorten(force, options_.max_force));
  if (stalled) force.setZero();
  Eigen::Vector3d change = force - given_;
  const bool slewed = shorten(change, options_.max_slew * options_.period);
  tell(Guarded::slewed, slewed);
  if (slewed) force = given_ + change;

  given_ = force;
  result.force = force;
  result.passivity = passivity_;
  return result;
}

}  // namespace palpate
