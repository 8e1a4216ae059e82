#pragma once

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

/// The mouse. The picture maps it to a target in the scene, which the tool follows like a
/// critically damped spring. Events at 60 Hz thus become smooth motion at the tick rate, with
/// continuous position and velocity and no overshoot. The device is away before the first target,
/// while there is none, and for one reading when it appears (MouseTarget). It renders no force and
/// lives in the scene.
class MouseDevice : public HapticDevice {
 public:
  /// `period` is the time between two calls of read(), s; positive.
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
  double period_, decay_;         ///< s; decay factor of one period
  std::uint32_t appearance_ = 0;  ///< MouseTarget::appearance at the last reading
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero(), velocity_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
