#include "viewer/devices/device_exchange.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

double inSeconds(DeviceExchange::Clock::duration time) {
  return std::chrono::duration<double>(time).count();
}

}  // namespace

/// Returns the time from a reading until a force that is written now takes effect, s. The device's
/// thread gets the force with its next call of force().
double DeviceExchange::delayOf(const Arrival& arrival, Clock::time_point now) noexcept {
  const double age = inSeconds(now - arrival.time), turn = inSeconds(arrival.turn),
               offset = inSeconds(arrival.offset);
  if (!(turn > 0)) return age;
  return offset + turn * std::max(0.0, std::floor((age - offset) / turn) + 1);
}

DeviceReading DeviceExchange::read(Clock::time_point now) noexcept {
  const Arrival arrival = readings_.read();
  const std::uint64_t unseen = arrival.number - seen_.number;  // readings since the last call
  DeviceReading reading = arrival.reading;
  const std::uint64_t oldest = std::min(arrival.oldest, unseen == 2  ? arrival.before
                                                        : unseen > 2 ? seen_.newest
                                                                     : UINT64_MAX);
  const auto ticksAgo = [this](std::uint64_t force) {
    return static_cast<std::uint16_t>(
        force == 0 ? 0 : std::min<std::uint64_t>(written_ - force + 1, UINT16_MAX));
  };
  reading.held = {ticksAgo(arrival.newest), ticksAgo(oldest), delayOf(arrival, now),
                  unseen > 0 && seen_.number > 0 ? inSeconds(arrival.time - seen_.time) : 0,
                  inSeconds(arrival.turn)};
  seen_ = arrival;
  if (reading.status == DeviceStatus::lost) return reading;
  if (now - arrival.time > silence)
    reading.status = DeviceStatus::lost;
  else
    reading.status = unseen > 0 ? DeviceStatus::fresh : DeviceStatus::repeated;
  return reading;
}

void DeviceExchange::deliver(const DeviceReading& reading, Clock::time_point now) noexcept {
  next_.reading = reading;
  next_.time = now;
  ++next_.number;
  readings_.write(next_);
  next_.before = next_.oldest;
  next_.oldest = next_.newest;
}

Eigen::Vector3d DeviceExchange::force(Clock::time_point now) noexcept {
  constexpr int share = 64;          // next_.turn decays by 1/share per turn
  constexpr double at_once = 0.125;  // fraction of a turn; a shorter delay is ignored
  if (taken_ != Clock::time_point{})
    next_.turn =
        std::max(std::min<Clock::duration>(now - taken_, silence), next_.turn - next_.turn / share);
  taken_ = now;
  next_.offset = std::min(now - next_.time, next_.turn);
  // Read the flag first. A device thread that sees the resume then also sees the zero force that
  // was written before the resume.
  const bool halted = halted_.load(std::memory_order_acquire);
  const NumberedForce& taken = forces_.read();
  const bool usable = !halted && taken.force.allFinite();
  const std::uint64_t number = usable ? taken.number : 0;
  // If the device takes a new force at once, it holds no older force until the next reading. If it
  // takes the new force later, it has also held the previous one, which then remains the oldest.
  if (number != next_.newest && inSeconds(now - next_.time) <= at_once * inSeconds(next_.turn))
    next_.oldest = number;
  next_.newest = number;
  return usable ? taken.force : Eigen::Vector3d::Zero().eval();
}

void DeviceExchange::setTrouble(const std::string& sentence) {
  const std::lock_guard lock(mutex_);
  trouble_ = sentence;
}

std::string DeviceExchange::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

}  // namespace palpate
