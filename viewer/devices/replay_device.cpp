#include "viewer/devices/replay_device.hpp"

#include <fmt/format.h>

namespace palpate {

ReplayDevice::ReplayDevice(Recording recording, double period, std::string source)
    : recording_(std::move(recording)), source_(std::move(source)) {
  traits_ = {recording_.profile, recording_.scene_frame, true};
  checkReplay(recording_, period, source_);
}

DeviceReading ReplayDevice::read() noexcept {
  const std::size_t tick = next_.load(std::memory_order_relaxed);
  if (tick >= recording_.readings.size())
    return {recording_.readings.back().position, 0, DeviceStatus::lost};
  next_.store(tick + 1, std::memory_order_relaxed);
  return recording_.readings[tick];
}

std::string ReplayDevice::trouble() const {
  if (!ended()) return {};
  return fmt::format("the recording {} has ended after {:.3f} s", source_,
                     static_cast<double>(readings()) / recording_.rate);
}

}  // namespace palpate
