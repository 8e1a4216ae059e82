#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>

#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

/// What passes between the haptic thread and the thread that speaks with a device: the newest
/// reading one way, the newest force the other. Neither side ever waits for the other. Forces are
/// numbered and all is stamped, so that each reading knows its HeldForces. `now` is for tests.
class DeviceExchange {
 public:
  using Clock = std::chrono::steady_clock;
  /// Without a reading for this long a device is lost.
  static constexpr std::chrono::milliseconds silence{50};

  // Haptic thread; real time.
  /// Fresh when a reading came since the last call; lost when none came for `silence`.
  DeviceReading read(Clock::time_point now = Clock::now()) noexcept;
  void write(const Eigen::Vector3d& force) noexcept { forces_.write({force, ++written_}); }

  // Any thread; real time.
  void halt() noexcept { halted_ = true; }
  /// What was written before the resume is seen by force() after it, or something newer.
  void resume() noexcept { halted_ = false; }
  bool halted() const noexcept { return halted_; }

  // The thread of the device.
  /// status: fresh or lost. reading.held is filled in.
  void deliver(const DeviceReading& reading, Clock::time_point now = Clock::now()) noexcept;
  /// N: the last one written; zero while halted, and when it is not finite. It counts as held from
  /// now on.
  Eigen::Vector3d force(Clock::time_point now = Clock::now()) noexcept;
  /// What is wrong, as a sentence; empty when nothing is. Any thread may ask.
  void setTrouble(const std::string& sentence);
  std::string trouble() const;

 private:
  struct Arrival {
    DeviceReading reading;
    Clock::time_point time{};
    /// Numbers of the forces that were held since the reading before, and of the oldest since the
    /// one before that; 0: zero.
    std::uint64_t oldest = 0, newest = 0, before = 0;
    Clock::duration turn{};    ///< between takings of forces, the longest of late
    Clock::duration offset{};  ///< from a reading to the taking of a force
    std::uint64_t number = 0;  ///< of the reading
  };
  struct NumberedForce {
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    std::uint64_t number = 0;
  };
  static double delayOf(const Arrival& arrival, Clock::time_point now) noexcept;
  TripleBuffer<Arrival> readings_;
  Arrival seen_;               ///< haptic thread
  std::uint64_t written_ = 0;  ///< haptic thread
  TripleBuffer<NumberedForce> forces_;
  Arrival next_;               ///< the device's thread
  Clock::time_point taken_{};  ///< when a force was; the device's thread
  std::atomic<bool> halted_ = false;
  mutable std::mutex mutex_;  ///< of trouble_; never taken by the haptic thread
  std::string trouble_;
};

/// What a device says of itself.
struct DeviceTraits {
  DeviceProfile profile;
  bool lives_in_scene = false, has_buttons = true;
};

/// A device that a thread of its own speaks with, through an exchange.
class ThreadedDevice : public HapticDevice {
 public:
  DeviceReading read() noexcept override { return exchange_->read(); }
  void write(const Eigen::Vector3d& force) noexcept override { exchange_->write(force); }
  void halt() noexcept override { exchange_->halt(); }
  void resume() noexcept override { exchange_->resume(); }
  std::string trouble() const override { return exchange_->trouble(); }
  DeviceProfile profile() const override { return traits_.profile; }
  bool livesInScene() const override { return traits_.lives_in_scene; }
  bool hasButtons() const override { return traits_.has_buttons; }

 protected:
  DeviceTraits traits_;  ///< constant after construction
  /// Shared, for a thread that may outlive this object where it hangs.
  const std::shared_ptr<DeviceExchange> exchange_ = std::make_shared<DeviceExchange>();
};

}  // namespace palpate
