#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>

#include "common/scene/device_profile.hpp"

namespace palpate {

enum class DeviceStatus : std::uint8_t {
  fresh,     ///< the reading is from this tick
  repeated,  ///< no new reading since the last tick; the last reading is returned again
  lost,      ///< unplugged, or silent for too long; the position is meaningless
  away       ///< the device works, but no hand is in the scene; the position is meaningless
};

/// Tells which forces a device held before a reading, and how late the next force will act. The
/// force guard computes the energy of the loop from this. The defaults describe a device that is
/// read and written within the tick.
struct HeldForces {
  /// Ticks since the newest and the oldest of these forces were written; 1: in the last tick; 0:
  /// the device held zero force.
  std::uint16_t newest = 1, oldest = 1;
  double delay = 0;     ///< time from the reading until the force computed from it acts, s
  double interval = 0;  ///< time since the previous reading, s; 0: unknown, one period per tick
  double hold = 0;      ///< time for which a force is held, s; 0: one period
  bool operator==(const HeldForces&) const = default;
};

/// One reading of a device. None of its values can be trusted; a device may send NaN.
struct DeviceReading {
  /// m, in the device's frame (HapticDevice)
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::uint32_t buttons = 0;  ///< bit n: button n is down; bit 0 lets go in glued mode
  DeviceStatus status = DeviceStatus::lost;
  HeldForces held = {};
};

/// The position of a tool that is absent: NaN.
inline Eigen::Vector3d nowhere() noexcept {
  return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
}

/// Position of the tool, set by the mouse in the window.
struct MouseTarget {
  Eigen::Vector3d position = nowhere();  ///< m, scene frame; not finite: no tool
  /// Number of times that the tool appeared. If the number has changed since the last reading, the
  /// tool was absent meanwhile, and it jumps to the position.
  std::uint32_t appearance = 0;
};

/// Properties that a device reports about itself.
struct DeviceTraits {
  DeviceProfile profile;
  bool lives_in_scene = false, has_buttons = false;
};

/// A haptic device. It reads the position of the hand, and may push the hand.
///
/// Frame: metres and newtons, right-handed, x to the right, y up, z toward the operator, origin in
/// the middle of the workspace. Devices that live in the scene (virtual hand, mouse, replay) use
/// the scene's frame, and their positions are not mapped; see livesInScene().
///
/// Threads: the haptic thread calls read() and then write() once per tick; they do not allocate,
/// lock, wait, throw or log. A device that must wait has a thread of its own and exchanges readings
/// and forces with it (triple_buffer.hpp). All other functions may be called from any thread.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  virtual DeviceReading read() noexcept = 0;
  /// Sets the force that acts until the next call, N. The force is always finite and at most
  /// profile().max_force.
  virtual void write(const Eigen::Vector3d& force) noexcept = 0;

  /// Sets the force to zero until resume(). Forces that are written meanwhile have no effect. The
  /// watchdog calls this from its own thread while the haptic thread hangs.
  virtual void halt() noexcept = 0;
  virtual void resume() noexcept = 0;

  /// Moves the tool that the mouse controls. Only the drawing thread calls this; other devices
  /// ignore it.
  virtual void moveTo(const MouseTarget& /*target*/) noexcept {}
  /// Returns whether this device is the mouse, whose tool moveTo() moves.
  virtual bool isMouse() const { return false; }

  virtual DeviceProfile profile() const { return traits_.profile; }
  /// Returns the number of readings after which the device is lost; 0: unlimited.
  virtual std::uint64_t readings() const { return 0; }
  virtual bool livesInScene() const { return traits_.lives_in_scene; }
  virtual bool hasButtons() const { return traits_.has_buttons; }
  virtual std::string name() const = 0;
  /// Requests real-time priority for the device's own threads, one below the priority of the loop.
  /// If the system refuses, returns the reasons as sentences; otherwise an empty string.
  virtual std::string askForRealTime() { return {}; }
  /// Returns a sentence for the user about the current problem ("no service at
  /// ws://localhost:10001: ..."); empty if there is no problem.
  virtual std::string trouble() const { return {}; }

 protected:
  DeviceTraits traits_;  ///< constant after construction
};

}  // namespace palpate
