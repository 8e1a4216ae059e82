#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "common/scene/device_profile.hpp"
#include "viewer/haptics/contact.hpp"

namespace palpate {

/// Limits of what a hand is given. There is no way to switch them off.
struct GuardOptions {
  double period = 1e-3;    ///< s, of the tick
  double max_force = 3.3;  ///< N; default: of the smallest device
  double max_slew = 330;   ///< N/s: the whole force in 10 ms
  double ramp = 0.05;      ///< s in which a step of the raw force is faded in
  double stall = 0.02;     ///< s without a fresh reading, after which the force goes to zero
  /// N/m, of the device: bounds the damping of the passivity controller
  double max_stiffness = 400;
  double energy_credit = 1e-4;  ///< J, dissipated or owed, that the observer remembers at most
};
/// Those of a device: max_force and max_stiffness of its profile, max_slew = max_force / 10 ms.
GuardOptions guardFor(const DeviceProfile& profile, double period);

/// Why a rendered force is not the raw one. Bits.
enum class Guarded : std::uint32_t {
  ramped = 1,       ///< a step of the raw force is being faded in
  damped = 2,       ///< the passivity controller takes energy out
  clamped = 4,      ///< longer than max_force
  slewed = 8,       ///< changing faster than max_slew
  stalled = 16,     ///< no fresh reading for `stall` seconds
  lost = 32,        ///< the device is gone
  not_finite = 64,  ///< the position or the raw force was not finite
  late = 128        ///< the loop itself hung; the force starts from zero again
};
inline constexpr int guard_count = 8;
/// "clamped", ... for bit n.
const char* guardWord(int bit);

struct GuardInput {
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< m, scene frame
  Touch touch;
  bool fresh = true;  ///< the reading is new
  bool lost = false;  ///< the device is gone
  bool away = false;  ///< no hand is in the scene: that the tool is not finite is no fault
  bool late = false;  ///< the loop hung before this tick
};

struct GuardedForce {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N; finite, |force| <= max_force
  std::uint32_t guards = 0;                         ///< Guarded bits
  /// J, of the passivity observer: what the hand put in less what is stored in the tissue.
  /// Negative: the loop has created energy.
  double passivity = 0;
};

/// From the force of a contact to the force of a device, tick by tick:
///   1. not finite, device gone, loop hung: the raw force counts as zero and a step;
///   2. ramp: a step d of the raw force (Touch::stepped, or 1.) is faded in: F - d (1 - s(t)), s
///      smooth from 0 to 1 in `ramp` seconds, so that the force goes on from where it was;
///   3. passivity observer and controller (Hannaford and Ryu 2002): the work of the hand, the sum
///      of -F . dx of the force it was given, less the energy stored in the tissue, may not be
///      negative. What is missing is taken out by damping against the motion, no more of it than
///      T |K| (K the local stiffness along the motion, T the period: twice the K T / 2 by which
///      holding the force for a tick makes a spring active) and than T max_stiffness. What is
///      stored counts by the share of the force that the clamp lets through, since no more than
///      that comes back. A step, which may change what is stored at will, is no work; at a step, at
///      the end of its ramp and at that of contact the observer forgets all but `energy_credit`;
///   4. clamp to max_force, keeping the direction;
///   5. slew: no faster than max_slew;
///   6. no fresh reading for `stall` seconds: toward zero as fast as max_slew allows.
/// A device that is lost, or a loop that hung, is given exactly zero at once. Numbers beyond 1e9
/// (N, m, J) are taken for not finite. Deterministic: a function of its inputs alone. One thread;
/// real time.
class ForceGuard {
 public:
  /// Error when a number is not finite, the period, max_force or max_slew not positive, or another
  /// negative.
  explicit ForceGuard(const GuardOptions& options);
  GuardedForce limit(const GuardInput& input) noexcept;
  void reset() noexcept;

 private:
  void startRamp(const Eigen::Vector3d& raw) noexcept;
  void restartObserver() noexcept;
  void observe(const GuardInput& input, bool stepped) noexcept;
  void forgetContact() noexcept;
  bool countStale(bool fresh) noexcept;
  Eigen::Vector3d fade() noexcept;
  Eigen::Vector3d damping(const Eigen::Matrix3d& stiffness) const noexcept;

  GuardOptions options_;
  Eigen::Vector3d given_ = Eigen::Vector3d::Zero();   ///< N, of the last tick
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();  ///< N, the step that is being faded in
  double ramp_time_ = 0;                              ///< s since the step
  bool usable_ = false;                               ///< the last raw force counted
  bool stalled_ = false;                              ///< the last tick was
  std::uint64_t ticks_since_fresh_ = 0;
  Eigen::Vector3d tool_ = Eigen::Vector3d::Zero();    ///< m, of the last tick, when usable_
  Eigen::Vector3d motion_ = Eigen::Vector3d::Zero();  ///< m, of the last tick
  bool touching_ = false;                             ///< the last tick was
  double stored_ = 0;                                 ///< J, of the last tick
  double clamp_share_ = 1;                            ///< of the last tick
  double passivity_ = 0;
};

}  // namespace palpate
