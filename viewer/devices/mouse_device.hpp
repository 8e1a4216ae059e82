#pragma once

#include <atomic>
#include <cstdint>

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

struct MouseDeviceOptions {
  double period = 1e-3;  ///< s, that passes with every read()
  double time_constant =
      0.015;  ///< s: about one event of a 60 Hz mouse, so that steps become one motion
};

/// A mouse or keys, as the picture turns them into a place in the scene. The tool follows that
/// place like a critically damped spring, so that events at 60 Hz become a motion at the rate of
/// the ticks: position and velocity are continuous, and it does not overshoot when the place stands
/// still. It feels no force. Lives in the scene.
class MouseDevice : public HapticDevice {
 public:
  /// start: m, scene frame, where the tool is before the first event. Error (bad input) for options
  /// that are not positive.
  MouseDevice(const Eigen::Vector3d& start, const MouseDeviceOptions& options,
              const DeviceProfile& profile);

  /// One thread only, that of the picture. position: m, scene frame; not finite: ignored.
  void moveTo(const Eigen::Vector3d& position, std::uint32_t buttons) noexcept;

  DeviceReading read() noexcept override;
  void write(const Eigen::Vector3d&) noexcept override {}
  void halt() noexcept override {}
  void resume() noexcept override {}
  DeviceProfile profile() const override { return profile_; }
  bool livesInScene() const override { return true; }
  bool hasButtons() const override { return true; }
  std::string name() const override { return "mouse"; }

 private:
  struct Target {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    std::uint32_t buttons = 0;
  };
  TripleBuffer<Target> targets_;
  DeviceProfile profile_;
  double period_, rate_, decay_;  ///< s, 1/s, of one period
  Eigen::Vector3d position_, velocity_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
