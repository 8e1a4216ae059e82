#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <string>

#include "common/scene/device_profile.hpp"

namespace palpate {

enum class DeviceStatus : std::uint8_t {
  fresh,     ///< the reading is of this tick
  repeated,  ///< nothing new came since the last tick; the last reading again
  lost,      ///< unplugged, or silent for too long; the position means nothing
  away       ///< all is well, and no hand is in the scene; the position means nothing
};

/// Which forces a device held on the way to a reading, and how late it takes the next one: so the
/// force guard knows the energy of the loop. The defaults are those of a device that is read and
/// written in the tick.
struct HeldForces {
  /// Ticks ago that they were written; 1: in the last tick, 0: the force was zero.
  std::uint16_t newest = 1, oldest = 1;
  double delay = 0;     ///< s, from the motion that was read to the force that answers it
  double interval = 0;  ///< s, since the reading before; 0: a period for each tick
  double hold = 0;      ///< s, that a force is held; 0: a period
  bool operator==(const HeldForces&) const = default;
};

/// One reading of a device. Nothing in it can be trusted: a device may send NaN.
struct DeviceReading {
  DeviceReading() = default;
  DeviceReading(const Eigen::Vector3d& at, std::uint32_t pressed, DeviceStatus is,
                const HeldForces& forces = {})
      : position(at), buttons(pressed), status(is), held(forces) {}

  /// m, in the frame of the device (HapticDevice)
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::uint32_t buttons = 0;  ///< bit n: button n is down; bit 0 lets go (contact.hpp)
  DeviceStatus status = DeviceStatus::lost;
  HeldForces held;
};

/// Where the mouse of the picture has the tool.
struct MouseTarget {
  /// m, scene frame; not finite: nowhere
  Eigen::Vector3d position = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  /// How often the tool came from nowhere. With another number than before it is there at once, and
  /// was nowhere in between.
  std::uint32_t appearance = 0;
};

/// A haptic device: something that says where the hand is, and may push it.
///
/// Frame: metres and newtons, right-handed, x to the right, y up, z toward the operator, origin in
/// the middle of the workspace. A device that lives in the scene instead (virtual hand, mouse,
/// replay) says so and is not mapped.
///
/// Threads: read() and write() belong to the haptic thread, which calls them once per tick, in this
/// order; they do not allocate, lock, wait, throw or log. A device that must wait for something has
/// a thread of its own and exchanges readings and forces with it (triple_buffer.hpp). All else may
/// be called from any thread.
class HapticDevice {
 public:
  virtual ~HapticDevice() = default;
  virtual DeviceReading read() noexcept = 0;
  /// Holds until the next call. Always finite and within profile().max_force. N.
  virtual void write(const Eigen::Vector3d& force) noexcept = 0;

  /// The force is zero from now on, whatever is written, until resume(). The watchdog calls this
  /// from its own thread while the haptic thread hangs.
  virtual void halt() noexcept = 0;
  virtual void resume() noexcept = 0;

  /// Called by the picture's thread alone, and heard by the device that is this mouse alone.
  virtual void moveTo(const MouseTarget& /*target*/) noexcept {}
  /// Whether it is the mouse, and hears moveTo().
  virtual bool isMouse() const { return false; }

  /// Limits of its force, stiffness and workspace.
  virtual DeviceProfile profile() const = 0;
  /// How many readings it has to give, after which it is lost; 0: no end.
  virtual std::uint64_t readings() const { return 0; }
  virtual bool livesInScene() const { return false; }
  virtual bool hasButtons() const { return false; }
  virtual std::string name() const = 0;
  /// Real-time priority for the device's own threads, one less than the loop's. Returns sentences
  /// about what was refused; empty where nothing was.
  virtual std::string askForRealTime() { return {}; }
  /// What is wrong, as a sentence for a person ("no service at ws://localhost:10001: ..."); empty
  /// when nothing is.
  virtual std::string trouble() const { return {}; }
};

}  // namespace palpate
