#include "viewer/devices/virtual_hand.hpp"

#include "common/base/error.hpp"

namespace palpate {
namespace {

constexpr int substeps = 4;  // substeps per period

}  // namespace

VirtualHand::VirtualHand(HandPath path, double period, const DeviceProfile& profile)
    : path_(std::move(path)), period_(period) {
  traits_ = {profile, true, true};
  // Condition for the stability of semi-implicit Euler for a damped oscillator: h^2 k / m + 2 h b /
  // m < 4.
  const double h = period / substeps;
  if (!(h > 0 && h * h * stiffness / mass + 2 * h * damping / mass < 4))
    throw badInput("virtual hand: a period of {} s is too long for its motion; raise the rate",
                   period);
  position_ = path_.at(path_.beginning()).position;
}

DeviceReading VirtualHand::read() noexcept {
  if (reads_ > 0) advance();
  const double time = path_.beginning() + static_cast<double>(reads_) * period_;
  ++reads_;
  return {position_, path_.at(time).buttons, DeviceStatus::fresh};
}

void VirtualHand::write(const Eigen::Vector3d& force) noexcept { force_ = force; }

void VirtualHand::advance() noexcept {
  const Eigen::Vector3d force = halted_ ? Eigen::Vector3d::Zero().eval() : force_;
  const double h = period_ / substeps;
  for (int step = 1; step <= substeps; ++step) {
    // Compute the time from the number of periods: a sum of steps would drift.
    const double time = path_.beginning() + static_cast<double>(reads_ - 1) * period_ + step * h;
    const HandTarget target = path_.at(time);
    const Eigen::Vector3d pull =
        stiffness * (target.position - position_) + damping * (target.velocity - velocity_) + force;
    velocity_ += h / mass * pull;
    position_ += h * velocity_;
  }
}

}  // namespace palpate
