#pragma once

#include <atomic>
#include <string>

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/recording.hpp"

namespace palpate {

/// Replays the readings of a recorded run: the n-th read() returns the n-th tick, with its status.
/// It renders no force. After the last tick it is lost. Lives in the frame of the recorded device.
class ReplayDevice : public HapticDevice {
 public:
  /// `source` names the recording in messages. `period` is the period of the replaying loop, s.
  /// Throws Error (bad input) if there is no tick, or if the recorded rate is not 1 / `period`,
  /// which would change the speed of the hand.
  ReplayDevice(Recording recording, double period, std::string source);

  DeviceReading read() noexcept override;
  void write(const Eigen::Vector3d&) noexcept override {}
  void halt() noexcept override {}
  void resume() noexcept override {}
  DeviceProfile profile() const override { return recording_.profile; }
  bool livesInScene() const override { return recording_.scene_frame; }
  bool hasButtons() const override { return true; }
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
