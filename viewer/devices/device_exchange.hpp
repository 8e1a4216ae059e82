#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/real_time.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

/// Exchanges the newest reading and the newest force between the haptic thread and the thread of a
/// device. Neither thread ever waits for the other.
///
/// Forces are numbered, and readings and forces are timestamped. The exchange computes from this
/// which forces the device held before each reading (HeldForces). Tests pass their own times as
/// `now`.
class DeviceExchange {
 public:
  using Clock = std::chrono::steady_clock;
  /// Time without a reading after which a device counts as lost.
  static constexpr std::chrono::milliseconds silence{50};

  // Called by the haptic thread; real time.
  /// Returns the newest reading. Its status is fresh if the reading arrived since the last call,
  /// lost if no reading arrived for `silence`, and repeated otherwise.
  DeviceReading read(Clock::time_point now = Clock::now()) noexcept;
  void write(const Eigen::Vector3d& force) noexcept { forces_.write({force, ++written_}); }

  // Called by any thread; real time.
  void halt() noexcept { halted_ = true; }
  /// After a resume, force() returns the last force written before it, or a newer one.
  void resume() noexcept { halted_ = false; }
  bool halted() const noexcept { return halted_; }

  // Called by the device's thread.
  /// Passes a reading to the haptic thread. Its status is fresh or lost; read() fills in `held`.
  void deliver(const DeviceReading& reading, Clock::time_point now = Clock::now()) noexcept;
  /// Returns the last force that was written, N; zero while halted or if that force is not finite.
  /// The exchange assumes that the device holds this force until the next call.
  Eigen::Vector3d force(Clock::time_point now = Clock::now()) noexcept;
  /// Set and return a sentence about the current problem; empty if there is none. Any thread.
  void setTrouble(const std::string& sentence);
  std::string trouble() const;

 private:
  struct Arrival {
    DeviceReading reading;
    Clock::time_point time{};
    /// Serial numbers of forces (NumberedForce::number); 0 stands for zero force. Between the
    /// previous reading and this one the device held the forces from `oldest` to `newest`. `before`
    /// is `oldest` of the previous reading.
    std::uint64_t oldest = 0, newest = 0, before = 0;
    Clock::duration turn{};    ///< recent maximum of the time between two calls of force()
    Clock::duration offset{};  ///< last time from a reading to the next call of force()
    std::uint64_t number = 0;  ///< serial number of the reading
  };
  struct NumberedForce {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    std::uint64_t number = 0;
  };
  static double delayOf(const Arrival& arrival, Clock::time_point now) noexcept;
  TripleBuffer<Arrival> readings_;
  Arrival seen_;               ///< used by the haptic thread
  std::uint64_t written_ = 0;  ///< used by the haptic thread
  TripleBuffer<NumberedForce> forces_;
  Arrival next_;               ///< used by the device's thread
  Clock::time_point taken_{};  ///< last call of force(); used by the device's thread
  std::atomic<bool> halted_ = false;
  mutable std::mutex mutex_;  ///< guards trouble_; the haptic thread never locks it
  std::string trouble_;
};

/// A device that has its own thread and is connected to the haptic thread by a DeviceExchange.
class ThreadedDevice : public HapticDevice {
 public:
  DeviceReading read() noexcept override { return exchange_->read(); }
  void write(const Eigen::Vector3d& force) noexcept override { exchange_->write(force); }
  void halt() noexcept override { exchange_->halt(); }
  void resume() noexcept override { exchange_->resume(); }
  std::string trouble() const override { return exchange_->trouble(); }
  std::string askForRealTime() override {
    return giveRealTime(thread(), "device", device_priority);
  }

 protected:
  virtual pthread_t thread() = 0;  ///< the device's thread
  /// Shared with the device's thread, which may hang and then outlive this object.
  const std::shared_ptr<DeviceExchange> exchange_ = std::make_shared<DeviceExchange>();
};

}  // namespace palpate
