#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/scene/device_profile.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/energy_limit.hpp"

namespace palpate {

/// Limits of the force on a hand. They cannot be switched off.
struct GuardOptions {
  double period = 1e-3;         ///< length of a tick, s
  double max_force = 3.3;       ///< N; default: limit of the weakest known device
  double max_slew = 0;          ///< N/s; 0: reaches max_force in 10 ms
  double ramp = 0.05;           ///< time in which a step of the raw force is faded in, s
  double stall = 0.02;          ///< the force goes to zero after this time without a fresh reading,
                                ///< s
  double max_stiffness = 400;   ///< limit of the device, N/m; only recorded, not enforced
  double energy_credit = 1e-4;  ///< largest surplus or deficit of energy that is remembered, J
  /// Part of the delay from a reading to its force that the device does not report (HeldForces), s.
  /// It is added to the reported delay; at most 30 periods.
  double delay = 0;
  double max_speed = 5;  ///< m/s; a faster motion is a false reading and is treated as a step
};
/// Returns the default limits, with max_force and max_stiffness taken from a device.
GuardOptions guardFor(const DeviceProfile& profile, double period);
/// Returns max_slew, N/s. If it is 0, returns the slew that reaches max_force in 10 ms.
double slewOf(const GuardOptions& options);

/// Reasons why the rendered force differs from the raw force, as bits.
enum class Guarded : std::uint32_t {
  ramped = 1,       ///< a step of the raw force is being faded in
  damped = 2,       ///< the hand would get back more energy than it put in
  clamped = 4,      ///< the force was longer than max_force
  slewed = 8,       ///< the force would have changed faster than max_slew
  stalled = 16,     ///< no fresh reading for `stall` seconds
  lost = 32,        ///< the device is gone
  not_finite = 64,  ///< the position or the raw force was not finite
  late = 128,       ///< the loop hung; the force starts from zero again
  beyond = 256      ///< outside the computed region; the raw force is a continuation
};
inline constexpr int guard_count = 9;
/// Returns the word for bit n, such as "clamped".
const char* guardWord(int bit);

struct GuardInput {
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< m, scene frame
  Touch touch;
  HeldForces held = {};
  bool fresh = true;  ///< the reading is from this tick
  bool lost = false;  ///< the device is gone
  bool away = false;  ///< no hand is in the scene, so a tool position that is not finite is
                      ///< not an error
  bool late = false;  ///< the loop hung before this tick
};

struct GuardedForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N; finite, |force| <= max_force
  std::uint32_t guards = 0;                         ///< Guarded bits
  /// Work of the hand minus the energy that the tissue gives back, J. Negative: the loop created
  /// energy.
  double passivity = 0;
};

/// Fades in a step of a force smoothly. One thread; real time.
class ForceRamp {
 public:
  /// period: length of a tick, s. duration: length of the fade, s.
  ForceRamp(double period, double duration)
      : period_(period), duration_(duration), time_(duration) {}
  void reset() noexcept { time_ = duration_; }
  /// Begins to fade in a step of the force, N. The step must include the rest of a step that is
  /// still being faded in.
  void begin(const Eigen::Vector3d& step) noexcept {
    step_ = step;
    time_ = 0;
  }
  /// Returns the part of the step that is not yet faded in, N, which the caller subtracts from the
  /// force. Call once per tick.
  Eigen::Vector3d next() noexcept;

 private:
  double period_, duration_, time_;  ///< s; time_: time since the step began
  Eigen::Vector3d step_ = Eigen::Vector3d::Zero();
};

/// Computes the force of the device from the force of the contact, tick by tick:
/// 1. Invalid input: if the position of the tool or the raw force is not finite, the raw force is
///    set to zero. This is a step, and so is the return to valid input.
/// 2. Ramp: a step d of the raw force (Touch::stepped, case 1, a motion faster than max_speed, or
///    the end of a stall) is faded in as F - d (1 - s(t)). The factor s goes smoothly from 0 to 1
///    in `ramp` seconds, so the force continues from its last value.
/// 3. Clamp: the force is shortened to max_force and keeps its direction.
/// 4. Energy: the hand gets back no more energy than it put in (EnergyLimit). A step may change the
///    stored energy by any amount without work of the hand, so the energy sums are restarted in
///    every tick until the ramp ends.
/// 5. Slew: the force changes at most at the rate max_slew.
/// 6. Stall: after `stall` seconds without a fresh reading, the force goes to zero at the rate
///    max_slew.
///
/// If the device is lost or the loop hung, the force is zero at once, and all earlier ticks are
/// forgotten. Numbers beyond 1e9 (N, m, J) are treated as not finite. Deterministic: the output
/// depends on the inputs only. One thread; real time.
class ForceGuard {
 public:
  /// Throws Error if a number is not finite, the period, max_force or max_speed is not positive,
  /// another option is negative, or the delay is longer than 30 periods.
  explicit ForceGuard(const GuardOptions& options);
  GuardedForce limit(const GuardInput& input) noexcept;
  void reset() noexcept;

 private:
  HeldForces delayed(HeldForces held) const noexcept;
  double renderedShare(const Eigen::Vector3d& raw) const noexcept;
  bool takeIn(const GuardInput& input, bool usable) noexcept;
  Eigen::Vector3d shaped(const Eigen::Vector3d& raw, const Touch& touch, bool stepped,
                         std::uint32_t& guards) noexcept;

  GuardOptions options_;
  ForceRamp ramp_;
  EnergyLimit energy_;
  Eigen::Vector3d given_ = Eigen::Vector3d::Zero();  ///< force of the last tick, N
  bool usable_ = false;                              ///< the last tick had a valid raw force
  bool stalled_ = false;                             ///< the last tick was stalled
  std::uint64_t ticks_since_fresh_ = 0;
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero();  ///< m, position at the last fresh
                                                    ///< reading; valid if usable_
};

}  // namespace palpate
