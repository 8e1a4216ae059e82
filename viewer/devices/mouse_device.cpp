#include "viewer/devices/mouse_device.hpp"

#include <cmath>

#include "common/base/error.hpp"

namespace palpate {

MouseDevice::MouseDevice(const Eigen::Vector3d& start, const MouseDeviceOptions& options,
                         const DeviceProfile& profile)
    : targets_(start), profile_(profile), period_(options.period), position_(start) {
  if (!(options.period > 0) || !(options.time_constant > 0) || !std::isfinite(options.period) ||
      !std::isfinite(options.time_constant) || !start.allFinite())
    throw badInput("mouse: period and time constant must be positive; they are {} s and {} s",
                   options.period, options.time_constant);
  rate_ = 1 / options.time_constant;
  decay_ = std::exp(-rate_ * period_);
}

void MouseDevice::moveTo(const Eigen::Vector3d& position) noexcept {
  if (position.allFinite()) targets_.write(position);
}

DeviceReading MouseDevice::read() noexcept {
  const Eigen::Vector3d& target = targets_.read();
  // The exact solution of e'' + 2 r e' + r^2 e = 0 after one period, e = position - target.
  const Eigen::Vector3d away = position_ - target;
  const Eigen::Vector3d drift = velocity_ + rate_ * away;
  position_ = target + decay_ * (away + period_ * drift);
  velocity_ = decay_ * (velocity_ - rate_ * period_ * drift);
  return {position_, 0, DeviceStatus::fresh};
}

}  // namespace palpate
