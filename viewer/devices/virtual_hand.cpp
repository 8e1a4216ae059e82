#include "viewer/devices/virtual_hand.hpp"

#include <cmath>

#include "common/base/error.hpp"

namespace palpate {
namespace {

void check(const VirtualHandOptions& options) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!positive(options.mass) || !positive(options.stiffness) || !positive(options.period) ||
      !(options.damping >= 0) || !std::isfinite(options.damping) || options.substeps < 1)
    throw badInput(
        "virtual hand: mass, stiffness and period must be positive, damping not negative, "
        "substeps at least 1; they are {} kg, {} N/m, {} s, {} N s/m and {}",
        options.mass, options.stiffness, options.period, options.damping, options.substeps);
  // Semi-implicit Euler of a damped oscillator: stable for h^2 k / m + 2 h b / m < 4.
  const double h = options.period / options.substeps;
  if (h * h * options.stiffness / options.mass + 2 * h * options.damping / options.mass >= 4)
    throw badInput(
        "virtual hand: steps of {} s are too long for {} kg, {} N/m and {} N s/m; "
        "raise the rate, or the number of substeps",
        h, options.mass, options.stiffness, options.damping);
}

}  // namespace

VirtualHand::VirtualHand(HandPath path, const VirtualHandOptions& options,
                         const DeviceProfile& profile)
    : path_(std::move(path)), options_(options), profile_(profile) {
  check(options_);
  position_ = path_.at(path_.beginning()).position;
}

DeviceReading VirtualHand::read() noexcept {
  if (reads_ > 0) advance();
  const double time = path_.beginning() + static_cast<double>(reads_) * options_.period;
  ++reads_;
  return {position_, path_.at(time).buttons, DeviceStatus::fresh};
}

void VirtualHand::write(const Eigen::Vector3d& force) noexcept { force_ = force; }

void VirtualHand::advance() noexcept {
  const Eigen::Vector3d force = halted_ ? Eigen::Vector3d::Zero().eval() : force_;
  const double h = options_.period / options_.substeps;
  for (int step = 1; step <= options_.substeps; ++step) {
    // The time counts whole periods: a sum of steps would drift away from it.
    const double time =
        path_.beginning() + static_cast<double>(reads_ - 1) * options_.period + step * h;
    const HandTarget target = path_.at(time);
    const Eigen::Vector3d pull = options_.stiffness * (target.position - position_) +
                                 options_.damping * (target.velocity - velocity_) + force;
    velocity_ += h / options_.mass * pull;
    position_ += h * velocity_;
  }
}

}  // namespace palpate
