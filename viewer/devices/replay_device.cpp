#include "viewer/devices/replay_device.hpp"

#include <cmath>

#include "common/base/error.hpp"

namespace palpate {
namespace {

/// The recorded device's limits under a name that lives as long as the program.
DeviceProfile profileOf(const RecordedRun& run) {
  DeviceProfile profile{"replay", run.max_force, run.max_stiffness, run.workspace_radius};
  for (const DeviceProfile& known : deviceProfiles())
    if (known.name == run.profile) profile.name = known.name;
  return profile;
}

}  // namespace

ReplayDevice::ReplayDevice(Recording recording, double period, std::string source)
    : recording_(std::move(recording)),
      source_(std::move(source)),
      profile_(profileOf(recording_.run)) {
  if (recording_.size() == 0) throw badInput("{}: the recording has no tick to replay", source_);
  if (std::abs(recording_.rate * period - 1) > 1e-6)
    throw badInput("{}: recorded at {} Hz, and cannot be replayed at {} Hz: use --rate {}", source_,
                   recording_.rate, 1 / period, recording_.rate);
}

DeviceReading ReplayDevice::read() noexcept {
  const std::size_t tick = next_.load(std::memory_order_relaxed);
  if (tick >= recording_.size()) return {recording_.positions.back(), 0, DeviceStatus::lost};
  next_.store(tick + 1, std::memory_order_relaxed);
  return {recording_.positions[tick], recording_.buttons[tick], recording_.status[tick]};
}

std::string ReplayDevice::trouble() const {
  if (!ended()) return {};
  return fmt::format("the recording {} has ended after {:.3f} s", source_,
                     static_cast<double>(recording_.size()) / recording_.rate);
}

}  // namespace palpate
