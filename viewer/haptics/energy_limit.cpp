#include "viewer/haptics/energy_limit.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Factor on K (D + T/2), see EnergyLimit. Much smaller factors let light masses gain energy.
constexpr double damping = 4;
/// Factors on the measured acceleration, because the measurement lags and the true acceleration
/// grows with the force. growing_out is used for the force while the hand moves out, growing_ahead
/// to predict when the force must begin to fall.
constexpr double growing_out = 1.3, growing_ahead = 2;
// m; more than the resolution of a device, less than a slow press moves in rest_duration
constexpr double rest_radius = 2e-4;
constexpr double rest_duration = 0.1;  // s
constexpr int halvings = 20;           // steps of the bisection for the force

/// Returns `value`, or `otherwise` if the value is too large or NaN.
double usableOr(double value, double otherwise) {
  return std::abs(value) <= EnergyLimit::largest_number ? value : otherwise;
}

/// Returns the newer value if both have the same sign, otherwise 0.
double agreed(double newer, double older) { return newer * older > 0 ? newer : 0; }

}  // namespace

/// Predicted motion in the direction of the force, beginning at the newest reading.
struct EnergyLimit::Outward {
  Eigen::Vector3d direction;  ///< unit
  double speed;               ///< m/s; mean speed of the last motion, and thus the speed `lag`
                              ///< seconds before the reading
  double acceleration;        ///< m/s^2, >= 0
  double lag;                 ///< s
  double at(double time) const { return speed * time + acceleration * time * (lag + 0.5 * time); }
  double speedAt(double time) const { return speed + acceleration * (lag + time); }
};

const Eigen::Vector3d& EnergyLimit::given(std::uint32_t ticks_ago) const noexcept {
  return given_[(tick_ - std::clamp(ticks_ago, 1U, remembered)) % remembered];
}

void EnergyLimit::give(const Eigen::Vector3d& force) noexcept {
  given_[tick_++ % remembered] = force;
}

/// Returns the work of the device on the hand. If the device may have held any of several forces,
/// returns the largest possible work.
double EnergyLimit::work(const Eigen::Vector3d& motion, const HeldForces& held) const noexcept {
  if (held.newest == 0) return 0;
  // If the device does not report HeldForces::interval, assume that it held a different force in
  // each tick since the last reading.
  const std::uint32_t untold = held.interval > 0 ? 0 : held.newest + age_ - 1;
  const std::uint32_t oldest = std::min(std::max<std::uint32_t>(held.oldest, untold), remembered);
  double largest = given(held.newest).dot(motion);
  for (std::uint32_t ticks = held.newest + 1U; ticks <= oldest; ++ticks)
    largest = std::max(largest, given(ticks).dot(motion));
  return largest;
}

void EnergyLimit::forgetMotion() noexcept {
  known_ = false;
  velocity_ = last_velocity_ = acceleration_ = last_acceleration_ = Eigen::Vector3d::Zero();
  rest_time_ = 0;
}

void EnergyLimit::move(const Eigen::Vector3d& motion, double interval) noexcept {
  last_velocity_ = velocity_;
  velocity_ = motion / interval;
  last_acceleration_ = acceleration_;
  acceleration_ = (velocity_ - last_velocity_) / (0.5 * (interval + interval_));
  interval_ = interval;
}

void EnergyLimit::forgiveAtRest(const Eigen::Vector3d& tool, double interval) noexcept {
  rest_time_ += interval;
  if ((tool - rest_).norm() > rest_radius) {
    rest_ = tool;
    rest_time_ = 0;
  }
  if (rest_time_ >= rest_duration) energy_ = std::max(energy_, stored_);
}

void EnergyLimit::observe(const Eigen::Vector3d& tool, const Touch& touch, double rendered,
                          const HeldForces& held, bool fresh) noexcept {
  ++age_;
  delay_ = std::max(usableOr(held.delay, 0), (age_ - (fresh ? 1 : 0)) * period_);
  hold_ = std::max(period_, usableOr(held.hold, 0));
  if (!fresh) return;
  const Eigen::Vector3d raw = rendered * touch.force;
  const double energy = touch.touching ? touch.energy : 0;
  if (known_) {
    const double interval = held.interval > 0 ? held.interval : age_ * period_;
    const Eigen::Vector3d motion = tool - tool_;
    move(motion, interval);
    energy_ -= work(motion, held);
    const double change = 0.5 * (rendered_ + rendered) * (energy - touch_energy_);
    stored_ += usableOr(change, -0.5 * (raw_ + raw).dot(motion));
    stored_ = std::max(stored_, 0.0);
    energy_ = std::clamp(energy_, -credit_, stored_ + credit_);
    forgiveAtRest(tool, interval);
  } else {
    interval_ = period_;
    rest_ = tool;
  }
  if (!touch.touching && given(1).isZero(0)) energy_ = stored_ = 0;
  known_ = true;
  age_ = 0;
  tool_ = tool;
  raw_ = raw;
  touch_energy_ = energy;
  rendered_ = rendered;
}

void EnergyLimit::restart(double stored) noexcept {
  const double left = std::clamp(passivity(), -credit_, credit_);
  stored_ = std::max(usableOr(stored, 0), 0.0);
  energy_ = stored_ + left;
}

EnergyLimit::Outward EnergyLimit::outward(const Eigen::Vector3d& direction,
                                          double growing) const noexcept {
  const double acceleration =
      agreed(acceleration_.dot(direction), last_acceleration_.dot(direction));
  return {direction, agreed(velocity_.dot(direction), last_velocity_.dot(direction)),
          growing * std::max(acceleration, 0.0), 0.5 * interval_};
}

/// Returns the energy that is left when the next force begins to act, J. Until then the device
/// holds the last forces that were written. A device that holds a force for longer than a period
/// skips some of the written forces. It is unknown which, so the larger work is assumed.
double EnergyLimit::available(const Outward& path) const noexcept {
  constexpr double jitter = 0.25;  // of a period
  const auto more =
      static_cast<std::uint32_t>(std::max(0.0, std::ceil(hold_ / period_ - jitter) - 1));
  double left = energy_, end = delay_;
  for (std::uint32_t ticks = 1; end > 0 && ticks <= remembered; ++ticks) {
    const double begin = std::max(0.0, end - period_);
    const double held =
        std::max(given(ticks).dot(path.direction), given(ticks + more).dot(path.direction));
    left -= held * (path.at(end) - path.at(begin));
    end = begin;
  }
  return std::max(left, 0.0);
}

/// Returns the force while the hand moves out, N: the tissue's force in the middle of the period,
/// times available / stored energy. The energy then lasts until the hand reaches the undeformed
/// surface. The result is below `force` by at most damping K (D + T/2) v.
double EnergyLimit::returned(double force, double stiffness, const Outward& path) const noexcept {
  const double middle = delay_ + 0.5 * hold_, speed = path.speedAt(middle);
  if (!(speed > 0)) return force;
  const double before = path.at(delay_);
  const double left = stored_ - force * before + 0.5 * rendered_ * stiffness * before * before;
  const double share = left > 0 ? available(path) / left : 1;
  const double raw = force / rendered_;  // N, before the clamp
  const double in_middle = std::clamp(raw - stiffness * path.at(middle), 0.0, force);
  const double wanted = std::min(force, share * in_middle);
  const double secant = stored_ > 0 ? 0.5 * force * force / stored_ : 0;
  return std::max(wanted, force - damping * std::max(stiffness, secant) * middle * speed);
}

/// Returns the largest force, N, for which the available energy suffices to hold it for a period
/// and then reduce it at the rate max_slew.
double EnergyLimit::releasable(double force, const Outward& path) const noexcept {
  const double end = delay_ + hold_, speed = path.speedAt(end);
  const double motion = path.at(end) - path.at(delay_), most = available(path);
  const auto affordable = [&](double f) {
    const double fall = f / max_slew_;  // s
    const double cost = f * (motion + fall * (speed / 2 + path.acceleration * fall / 6));
    return cost <= most;
  };
  if (affordable(force)) return force;
  double low = 0, high = force;
  for (int n = 0; n < halvings; ++n) {
    const double middle = 0.5 * (low + high);
    (affordable(middle) ? low : high) = middle;
  }
  return low;
}

bool EnergyLimit::bound(Eigen::Vector3d& force, const Eigen::Matrix3d& stiffness) const noexcept {
  const double length = force.norm();
  if (!(length > 0)) return false;
  const Eigen::Vector3d direction = force / length;
  const double along = std::max(usableOr(-direction.dot(stiffness * direction), 0), 0.0);
  const double most = std::min(returned(length, along, outward(direction, growing_out)),
                               releasable(length, outward(direction, growing_ahead)));
  if (!(most < length)) return false;
  force *= most / length;
  return true;
}

}  // namespace palpate
