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

/// Exchanges the newest reading and the newest force between the haptic thread and the thread of a
/// device. Neither side ever waits for the other. Forces are numbered and everything is
/// timestamped, to compute the HeldForces of each reading. Tests pass `now`.
class DeviceExchange {
 public:
  using Clock = std::chrono::steady_clock;
  /// Time without a reading after which a device counts as lost.
  static constexpr std::chrono::milliseconds silence{50};

  // For the haptic thread; real time.
  /// Returns the newest reading: fresh if it came since the last call, lost if none came for
  /// `silence`, else repeated.
  DeviceReading read(Clock::time_point now = Clock::now()) noexcept;
  void write(const Eigen::Vector3d& force) noexcept { forces_.write({force, ++written_}); }

  // For any thread; real time.
  void halt() noexcept { halted_ = true; }
  /// force() calls after a resume return the last force written before it, or a newer one.
  void resume() noexcept { halted_ = false; }
  bool halted() const noexcept { return halted_; }

  // For the device's thread.
  /// Passes on a reading of status fresh or lost. read() fills in its `held`.
  void deliver(const DeviceReading& reading, Clock::time_point now = Clock::now()) noexcept;
  /// Returns the last force written, N; zero while halted or if it is not finite. The device holds
  /// it from now on.
  Eigen::Vector3d force(Clock::time_point now = Clock::now()) noexcept;
  /// A sentence about the current problem; empty if there is none. Any thread.
  void setTrouble(const std::string& sentence);
  std::string trouble() const;

 private:
  struct Arrival {
    DeviceReading reading;
    Clock::time_point time{};
    /// Numbers of the oldest and newest force held since the previous reading, and of the oldest
    /// force held in the interval before; 0: zero force.
    std::uint64_t oldest = 0, newest = 0, before = 0;
    Clock::duration turn{};    ///< time between calls of force(): a recent maximum
    Clock::duration offset{};  ///< from a reading to the next call of force()
    std::uint64_t number = 0;  ///< the reading's number
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
  Clock::time_point taken_{};  ///< last call of force(); the device's thread
  std::atomic<bool> halted_ = false;
  mutable std::mutex mutex_;  ///< guards trouble_; the haptic thread never takes it
  std::string trouble_;
};

/// The properties that a device reports.
struct DeviceTraits {
  DeviceProfile profile;
  bool lives_in_scene = false, has_buttons = true;
};

/// A device with a thread of its own, connected through an exchange.
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
  /// Shared with a thread that may hang and then outlive this object.
  const std::shared_ptr<DeviceExchange> exchange_ = std::make_shared<DeviceExchange>();
};

}  // namespace palpate
