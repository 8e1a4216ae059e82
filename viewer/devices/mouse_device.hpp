#pragma once

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

/// The mouse. The picture maps the mouse pointer to a target in the scene, and the tool follows
/// this target like a critically damped spring. Events at 60 Hz thus become a smooth motion at the
/// tick rate, with continuous position and velocity and without overshoot.
///
/// The status of the device is `away` while there is no target, and for one reading when a target
/// appears (MouseTarget). The device renders no force, and its positions are in the scene's frame.
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
  std::string name() const override { return "mouse"; }

 private:
  TripleBuffer<MouseTarget> targets_;
  double period_, decay_;         ///< s; factor by which the distance to the target decreases in
                                  ///< one period
  std::uint32_t appearance_ = 0;  ///< MouseTarget::appearance at the last reading
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero(), velocity_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
