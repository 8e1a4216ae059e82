#include "viewer/devices/device_exchange.hpp"

namespace palpate {

DeviceReading DeviceExchange::read() noexcept {
  const Arrival& arrival = readings_.read();
  const bool fresh = arrival.time != last_arrival_;
  last_arrival_ = arrival.time;
  DeviceReading reading = arrival.reading;
  if (reading.status == DeviceStatus::lost) return reading;
  // steady_clock does not enter the kernel here (vDSO).
  if (Clock::now() - arrival.time > silence)
    reading.status = DeviceStatus::lost;
  else
    reading.status = fresh ? DeviceStatus::fresh : DeviceStatus::repeated;
  return reading;
}

Eigen::Vector3d DeviceExchange::force() noexcept {
  // In this order: who sees the resume also sees the zero that was written before it.
  if (halted_.load(std::memory_order_acquire)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d& force = forces_.read();
  return force.allFinite() ? force : Eigen::Vector3d::Zero().eval();
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
