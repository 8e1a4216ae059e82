#include "viewer/devices/mouse_device.hpp"

#include <cmath>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// 1/s: about one event of a 60 Hz mouse, so that steps become one motion.
constexpr double spring_rate = 1 / 0.015;

}  // namespace

MouseDevice::MouseDevice(const Eigen::Vector3d& start, double period, const DeviceProfile& profile)
    : targets_(start),
      profile_(profile),
      period_(period),
      decay_(std::exp(-spring_rate * period)),
      position_(start) {
  PALPATE_ASSERT(period > 0 && std::isfinite(period), "the rate of a loop is checked before");
  PALPATE_ASSERT(start.allFinite(), "the tool begins beside the body");
}

void MouseDevice::moveTo(const Eigen::Vector3d& position) noexcept {
  if (position.allFinite()) targets_.write(position);
}

DeviceReading MouseDevice::read() noexcept {
  const Eigen::Vector3d& target = targets_.read();
  // The exact solution of e'' + 2 r e' + r^2 e = 0 after one period, e = position - target.
  const Eigen::Vector3d away = position_ - target;
  const Eigen::Vector3d drift = velocity_ + spring_rate * away;
  position_ = target + decay_ * (away + period_ * drift);
  velocity_ = decay_ * (velocity_ - spring_rate * period_ * drift);
  return {position_, 0, DeviceStatus::fresh};
}

}  // namespace palpate
