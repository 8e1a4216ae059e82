#pragma once

#include <atomic>
#include <string>

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/recording.hpp"

namespace palpate {

/// Gives the readings of a recorded run again: the n-th read() is the n-th tick of it, its status
/// included. It feels nothing. After the last tick it is lost. Lives where the recorded device
/// lived.
class ReplayDevice : public HapticDevice {
 public:
  /// `source` names it in messages. Error (bad input) when there is no tick, or when the rate is
  /// not the one that `period` (s, of the loop it is replayed in) means: the hand would move faster
  /// or slower than it did.
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
