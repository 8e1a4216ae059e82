#include "viewer/devices/mouse_device.hpp"

#include <cmath>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// 1/s. The time constant is about the time between two events of a 60 Hz mouse, so that the motion
/// between events is smooth.
constexpr double spring_rate = 1 / 0.015;

}  // namespace

MouseDevice::MouseDevice(double period, const DeviceProfile& profile)
    : period_(period), decay_(std::exp(-spring_rate * period)) {
  PALPATE_ASSERT(period > 0 && std::isfinite(period), "the period of the mouse must be positive");
  traits_ = {.profile = profile, .lives_in_scene = true};
}

DeviceReading MouseDevice::read() noexcept {
  const auto& [target, appearance] = targets_.read();
  if (!target.allFinite()) return {position_, 0, DeviceStatus::away};
  if (appearance != appearance_) {
    appearance_ = appearance;
    position_ = target;
    velocity_.setZero();
    return {position_, 0, DeviceStatus::away};
  }
  // Exact solution of e'' + 2 r e' + r^2 e = 0 after one period, where e = position - target and r
  // = spring_rate.
  const Eigen::Vector3d away = position_ - target;
  const Eigen::Vector3d drift = velocity_ + spring_rate * away;
  position_ = target + decay_ * (away + period_ * drift);
  velocity_ = decay_ * (velocity_ - spring_rate * period_ * drift);
  return {position_, 0, DeviceStatus::fresh};
}

}  // namespace palpate
