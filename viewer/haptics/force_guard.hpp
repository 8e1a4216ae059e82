#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/scene/device_profile.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/energy_limit.hpp"

namespace palpate {

/// Limits of what a hand is given. There is no way to switch them off.
struct GuardOptions {
  double period = 1e-3;         ///< s, of the tick
  double max_force = 3.3;       ///< N; default: of the smallest device
  double max_slew = 0;          ///< N/s; 0: the whole force in 10 ms
  double ramp = 0.05;           ///< s in which a step of the raw force is faded in
  double stall = 0.02;          ///< s without a fresh reading, after which the force goes to zero
  double max_stiffness = 400;   ///< N/m, of the device; recorded, and no limit of the guard
  double energy_credit = 1e-4;  ///< J, dissipated or owed, that is remembered at most
  /// s, from a reading to the force that answers it, beyond what the readings tell (HeldForces);
  /// at most 30 periods
  double delay = 0;
  double max_speed = 5;  ///< m/s, of a hand; a faster motion is a false reading: a step
};
/// Those of a device: its max_force and max_stiffness.
GuardOptions guardFor(const DeviceProfile& profile, double period);
/// N/s: max_slew, or what 0 stands for.
double slewOf(const GuardOptions& options);

/// Why a rendered force is not the raw one. Bits.
enum class Guarded : std::uint32_t {
  ramped = 1,       ///< a step of the raw force is being faded in
  damped = 2,       ///< the hand would get more energy back than it put in
  clamped = 4,      ///< longer than max_force
  slewed = 8,       ///< changing faster than max_slew
  stalled = 16,     ///< no fresh reading for `stall` seconds
  lost = 32,        ///< the device is gone
  not_finite = 64,  ///< the position or the raw force was not finite
  late = 128,       ///< the loop itself hung; the force starts from zero again
  beyond = 256      ///< deeper than was computed: the raw force is that of the continuation
};
inline constexpr int guard_count = 9;
/// "clamped", ... for bit n.
const char* guardWord(int bit);

struct GuardInput {
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< m, scene frame
  Touch touch;
  HeldForces held;
  bool fresh = true;  ///< the reading is new
  bool lost = false;  ///< the device is gone
  bool away = false;  ///< no hand is in the scene: that the tool is not finite is no fault
  bool late = false;  ///< the loop hung before this tick
};

struct GuardedForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N; finite, |force| <= max_force
  std::uint32_t guards = 0;                         ///< Guarded bits
  /// J, what the hand put in less what the tissue gives back. Negative: the loop created energy.
  double passivity = 0;
};

/// Fades steps of a force in: smoothly, from none of a step to all of it. One thread; real time.
class ForceRamp {
 public:
  /// s, of a tick and of a step.
  ForceRamp(double period, double duration)
      : period_(period), duration_(duration), time_(duration) {}
  void reset() noexcept { time_ = duration_; }
  /// The force is to change by `step` N; what was left of another is in it.
  void begin(const Eigen::Vector3d& step) noexcept {
    step_ = step;
    time_ = 0;
  }
  /// Each tick: what is left of the step, N, to be taken from the force.
  Eigen::Vector3d next() noexcept;

 private:
  double period_, duration_, time_;  ///< s; the last since the step
  Eigen::Vector3d step_ = Eigen::Vector3d::Zero();
};

/// From the force of a contact to the force of a device, tick by tick:
///   1. not finite, device gone, loop hung: the raw force counts as zero and a step;
///   2. ramp: a step d of the raw force (Touch::stepped, 1., or a motion faster than max_speed) is
///      faded in: F - d (1 - s(t)), s smooth from 0 to 1 in `ramp` seconds, so that the force goes
///      on from where it was;
///   3. clamp to max_force, keeping the direction;
///   4. energy: the hand gets back no more than it put in (EnergyLimit). A step, which may change
///      what is stored at will, is no work: until its ramp ends the sums begin anew;
///   5. slew: no faster than max_slew;
///   6. no fresh reading for `stall` seconds: toward zero as fast as max_slew allows.
/// A device that is lost, or a loop that hung, is given exactly zero at once. Numbers beyond 1e9
/// (N, m, J) are taken for not finite. Deterministic: a function of its inputs alone. One thread;
/// real time.
class ForceGuard {
 public:
  /// Error when a number is not finite, the period, max_force or max_speed not positive, another
  /// negative, or the delay too long.
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
  Eigen::Vector3d given_ = Eigen::Vector3d::Zero();  ///< N, of the last tick
  bool usable_ = false;                              ///< the last raw force counted
  bool stalled_ = false;                             ///< the last tick was
  std::uint64_t ticks_since_fresh_ = 0;
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero();  ///< m, of the last fresh reading, when usable_
};

}  // namespace palpate
