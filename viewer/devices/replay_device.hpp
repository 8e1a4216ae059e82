#pragma once

#include <atomic>
#include <string>

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/recording.hpp"

namespace palpate {

/// Replays the readings of a recorded run. Call n of read() returns the reading of tick n with its
/// status; after the last tick the device is lost. The device renders no force. Its positions are
/// in the frame of the recorded device.
class ReplayDevice : public HapticDevice {
 public:
  /// `source` names the recording in messages. `period` is the period of the loop that replays it,
  /// s. Throws the errors of checkReplay().
  ReplayDevice(Recording recording, double period, std::string source);

  DeviceReading read() noexcept override;
  void write(const Eigen::Vector3d&) noexcept override {}
  void halt() noexcept override {}
  void resume() noexcept override {}
  std::string name() const override { return "replay of " + source_; }
  std::string trouble() const override;

  std::uint64_t readings() const override { return recording_.readings.size(); }
  bool ended() const noexcept { return next_.load(std::memory_order_relaxed) >= readings(); }

 private:
  const Recording recording_;
  std::string source_;
  std::atomic<std::size_t> next_ = 0;
};

}  // namespace palpate
