#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/force_guard.hpp"
#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/live_touch.hpp"

namespace palpate {

/// Inputs and results of one tick. Passed by value to other threads (drawing, recording).
struct HapticState {
  std::uint64_t tick = 0;  ///< number of the tick, from 1
  double time = 0;         ///< tick * period, s; not wall-clock time
  DeviceReading reading;
  /// last finite position of the tool, m, scene frame
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();
  Touch touch;
  /// force written to the device, N, scene frame
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  std::uint32_t guards = 0;            ///< Guarded bits
  double passivity = 0;                ///< J, as GuardedForce::passivity
  std::int32_t model = 0, method = 0;  ///< indices of the model and the method in use
  std::optional<Hold> hold = {};       ///< a second finger that holds the body
  HoldForce hold_force = {};           ///< N, scene frame, of the tissue on this finger

  /// Returns the position at which to draw the tool, m, scene frame. It stops at the edge of the
  /// computed region.
  Eigen::Vector3d shownTool() const noexcept { return tool - touch.excess(); }
};

/// A command from another thread to the haptic thread.
struct HapticCommand {
  enum class Kind : std::uint8_t {
    use,      ///< use this model and method (indices)
    replace,  ///< replace this model by `replacement`; the contact continues
    release,  ///< end the contact
    hold,     ///< leave a second finger at the touch and end the contact, or let this finger go
  } kind = Kind::use;
  std::int32_t model = 0, method = 0;
  /// For `replace`. Must stay valid until it is replaced itself or the HapticTick is destroyed. Its
  /// first method must be prepared.
  const HapticModel* replacement = nullptr;
};

/// Maps a device's frame to the scene: tool = origin + scale * rotation * position. Forces are
/// rotated back but not scaled, so newtons stay newtons. The hand therefore feels `scale` times the
/// tissue's stiffness per metre of its own motion.
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
/// Returns the map that fits a device's workspace around the touchable surface. For devices that
/// live in the scene it is the identity. For other devices it does not rotate. Its scale is at
/// least 1, and so large that the workspace of `limits` contains the touchable vertices and the
/// displacements around them.
WorkspaceMap workspaceFor(const HapticModel& model, const HapticDevice& device,
                          const DeviceProfile& limits);

struct TickOptions {
  double period = 1e-3;  ///< s
  ContactOptions contact;
  GuardOptions guard;
  WorkspaceMap map;
  /// Where a second finger holds the body in each tick, from the first; empty: commands move it.
  /// Used only with a live solver. Must outlive the HapticTick.
  std::span<const std::optional<Hold>> holds = {};
};

/// One tick of the haptic loop: reads the device, finds the contact, evaluates the force, guards it
/// and writes it. A tick has no clock and no thread, so the same readings give bitwise identical
/// forces. run() and obey() are real time: they do not allocate, lock, throw or log.
class HapticTick {
 public:
  /// models: at least one; the first method of the first model must be prepared. The models and the
  /// device must outlive this object.
  HapticTick(std::vector<const HapticModel*> models, HapticDevice& device,
             const TickOptions& options);

  /// Runs one tick. late: whether the loop hung before this tick or the device was halted; has no
  /// effect while the device is lost.
  const HapticState& run(bool late = false) noexcept;
  /// Carries out a command. Ignores a command with an unknown model or method, or with a method
  /// that is not prepared.
  void obey(const HapticCommand& command) noexcept;
  const HapticState& state() const noexcept { return state_; }
  const TickOptions& options() const noexcept { return options_; }

 private:
  void moveHold() noexcept;
  void leaveOrLetGo() noexcept;

  std::vector<const HapticModel*> models_;
  HapticDevice& device_;
  TickOptions options_;
  Contact contact_;
  ForceGuard guard_;
  HapticState state_;
  std::optional<Hold> left_;  ///< the second finger that a command left
};

}  // namespace palpate
