#pragma once

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

/// The mouse, as the picture turns it into a place in the scene. The tool follows that place like a
/// critically damped spring, so that events at 60 Hz become a motion at the rate of the ticks:
/// position and velocity are continuous, and it does not overshoot when the place stands still. It
/// is away until the first place, while there is none, and for one reading where it appears
/// (MouseTarget). It feels no force. Lives in the scene.
class MouseDevice : public HapticDevice {
 public:
  /// period: s, positive, that passes with every read().
  MouseDevice(double period, const DeviceProfile& profile);

  void moveTo(const MouseTarget& target) noexcept override { targets_.write(target); }
  bool isMouse() const override { return true; }
  DeviceReading read() noexcept override;
  void write(const Eigen::Vector3d&) noexcept override {}
  void halt() noexcept override {}
  void resume() noexcept override {}
  DeviceProfile profile() const override { return profile_; }
  bool livesInScene() const override { return true; }
  std::string name() const override { return "mouse"; }

 private:
  TripleBuffer<MouseTarget> targets_;
  DeviceProfile profile_;
  double period_, decay_;         ///< s; of the distance in a period at most
  std::uint32_t appearance_ = 0;  ///< MouseTarget's, of the last reading
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero(), velocity_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
