#pragma once

#include <atomic>
#include <mutex>
#include <string>

#include "viewer/haptics/haptic_device.hpp"

namespace palpate::test {

/// A device controlled by the test: it returns the reading that was laid into it and keeps the last
/// written force.
class TrayDevice : public HapticDevice {
 public:
  explicit TrayDevice(const DeviceProfile& profile = {"tray", 2, 500, 0.06}) : profile_(profile) {}

  void lay(const DeviceReading& reading) {
    const std::lock_guard lock(mutex_);
    reading_ = reading;
  }
  Eigen::Vector3d force() const {
    const std::lock_guard lock(mutex_);
    return force_;
  }

  DeviceReading read() noexcept override {
    const std::lock_guard lock(mutex_);
    return reading_;
  }
  void write(const Eigen::Vector3d& force) noexcept override {
    const std::lock_guard lock(mutex_);
    force_ = force;
  }
  void halt() noexcept override {}
  void resume() noexcept override {}
  DeviceProfile profile() const override { return profile_; }
  bool hasButtons() const override { return true; }
  std::string name() const override { return "tray"; }

 private:
  DeviceProfile profile_;
  mutable std::mutex mutex_;
  DeviceReading reading_{Eigen::Vector3d::Zero(), 0, DeviceStatus::fresh};
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate::test
