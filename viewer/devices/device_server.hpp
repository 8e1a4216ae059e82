#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <zmq.hpp>

#include "common/wire/curve.hpp"
#include "viewer/devices/device_wire.hpp"
#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// Lends a device to one simulator on another machine (NetworkDevice).
///
/// A thread of its own reads the device at `rate`, sends every reading to the client that holds it
/// and writes the client's newest force. The client is not trusted: a force that is not finite is
/// ignored, and a longer one than the device's limit is shortened. A force is valid for as long as
/// it says, from when the reading that it answers was sent: one that the network held back is
/// ignored when it arrives, and when no newer one came in time the force is zero. A client that is
/// silent for a second loses the device to the next. At the end zero force is written last.
class DeviceServer {
 public:
  struct State {
    bool held = false;           ///< a client has the device
    std::uint64_t readings = 0;  ///< that were sent
    std::uint64_t forces = 0;    ///< that were followed
    std::uint64_t garbage = 0;   ///< messages that made no sense, or forces that were not finite
    std::uint64_t outdated = 0;  ///< forces that came when they were not valid any more
    std::uint64_t lapses = 0;    ///< times that a client's force went out of date and became zero
    std::string fault;           ///< why the thread ended, if it did
  };

  /// The device must outlive this object and be used by nobody else. endpoint: port * lets the
  /// system choose. rate: Hz, at which the device is read, 1 to 100000. keys: only an operator
  /// gets the device; nothing: anybody. Error when it cannot listen there, and
  /// (bad input) for another rate.
  DeviceServer(HapticDevice& device, const std::string& endpoint, double rate = 1000,
               const std::optional<KeyFolder>& keys = std::nullopt);

  /// With the port that the system chose.
  const std::string& endpoint() const { return endpoint_; }
  State state() const;

 private:
  using Clock = std::chrono::steady_clock;

  // On the thread of the server.
  void run(const std::stop_token& stop, double rate);
  void turn();
  void handle(const IncomingDeviceMessage& incoming);
  void refuse(const std::string& peer, const std::string& why);
  void greet(const std::string& peer, const wire::DeviceGreeting& greeting);
  void follow(const wire::DeviceForce& force);
  void release();
  void sendReading(const DeviceReading& reading);
  void count(std::uint64_t State::*number);
  /// When that reading was sent; nothing when it was never sent, or longer ago than any force is
  /// valid.
  std::optional<Clock::time_point> sentAt(std::uint64_t reading) const;

  HapticDevice& device_;
  const DeviceProfile profile_;
  zmq::context_t context_;
  std::optional<ZapHandler> zap_handler_;  ///< before the socket: it goes after it
  zmq::socket_t socket_;
  std::string endpoint_;

  std::string holder_;  ///< routing id; empty: free
  Clock::time_point last_heard_, valid_until_, last_trouble_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  bool pushing_ = false;  ///< force_ is in date
  std::uint64_t last_force_ = 0, sequence_ = 0;
  /// When the last readings were, the last of them number sequence_.
  std::deque<Clock::time_point> sent_;
  std::string trouble_;

  mutable std::mutex mutex_;
  State state_;          ///< guarded by mutex_
  std::jthread thread_;  ///< the last member: it ends before what it uses goes
};

}  // namespace palpate
