#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/force_guard.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// All that one tick knew and did. Goes to other threads by value: picture, recording.
struct HapticState {
  std::uint64_t tick = 0;  ///< counted from 1
  double time = 0;         ///< s, tick * period: not the clock of the wall
  DeviceReading reading;
  /// m, scene frame; the last that was known, always finite
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  Touch touch;
  /// N, scene frame: what was written to the device
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  std::uint32_t guards = 0;            ///< Guarded bits
  double passivity = 0;                ///< J, GuardedForce
  std::int32_t model = 0, method = 0;  ///< in use

  /// m, scene frame: where pictures show the tool, which stops where the answers end.
  Eigen::Vector3d shownTool() const noexcept { return tool - touch.excess(); }
};

/// What another thread asks of the haptic thread.
struct HapticCommand {
  enum class Kind : std::uint8_t {
    use,      ///< model and method, by number
    release,  ///< end the contact
  } kind = Kind::use;
  std::int32_t model = 0, method = 0;
};

/// From the frame of a device to that of the scene: tool = origin + scale * rotation * position.
/// Forces go back by the transposed rotation alone: newtons stay newtons, only lengths are scaled
/// (the hand then feels `scale` times the stiffness per metre of its own motion).
struct WorkspaceMap {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double scale = 1;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< m
  Eigen::Vector3d toScene(const Eigen::Vector3d& position) const noexcept {
    return origin + scale * (rotation * position);
  }
  Eigen::Vector3d toDevice(const Eigen::Vector3d& force) const noexcept {
    return rotation.transpose() * force;
  }
};
/// The device's workspace around what is touchable: identity for devices that live in the scene;
/// else the scale at which the workspace of `limits` holds the touchable vertices and the
/// displacements around them, at least 1; the device's axes are the scene's.
WorkspaceMap workspaceFor(const HapticModel& model, const HapticDevice& device,
                          const DeviceProfile& limits);

struct TickOptions {
  double period = 1e-3;  ///< s
  ContactOptions contact;
  GuardOptions guard;
  WorkspaceMap map;
};

/// One tick of the haptic loop: read, find contact, evaluate, guard, write. Knows no clock and no
/// thread, so that the same readings give the same forces to the last bit. run() and obey() are
/// real time: they do not allocate, lock, throw or log.
class HapticTick {
 public:
  /// models: at least one, to be switched between, the first method of the first prepared; they and
  /// the device must outlive this object.
  HapticTick(std::vector<const HapticModel*> models, HapticDevice& device,
             const TickOptions& options);

  /// late: the loop hung before this tick, or the device was halted; not told while the device is
  /// lost.
  const HapticState& run(bool late = false) noexcept;
  /// Commands that name what does not exist, or a method that is not prepared, are ignored.
  void obey(const HapticCommand& command) noexcept;
  const HapticState& state() const noexcept { return state_; }
  const TickOptions& options() const noexcept { return options_; }

 private:
  std::vector<const HapticModel*> models_;
  HapticDevice& device_;
  TickOptions options_;
  Contact contact_;
  ForceGuard guard_;
  HapticState state_;
};

}  // namespace palpate
