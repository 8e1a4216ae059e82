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

/// Lends a device to one simulator at a time on another machine (NetworkDevice).
///
/// A thread of its own reads the device at `rate`, sends each reading to the client that holds the
/// device, and writes the client's newest force. The client is not trusted:
/// - A force that is not finite is ignored. A force above the device's limit is scaled down to it.
/// - Each force states how long it is valid, counted from the time its reading was sent. A force
///   that arrives later is ignored, and without a valid force the device gets zero.
/// - A client that is silent for a second loses the device to the next one.
///
/// The last force written at the end is zero.
class DeviceServer {
 public:
  struct State {
    bool held = false;           ///< a client has the device
    std::uint64_t readings = 0;  ///< number sent
    std::uint64_t forces = 0;    ///< number accepted
    std::uint64_t garbage = 0;   ///< invalid messages, and forces that are not finite
    std::uint64_t outdated = 0;  ///< forces that arrived too late
    std::uint64_t lapses = 0;    ///< times that the force expired and became zero
    std::string fault;           ///< reason for the end of the thread; empty if it runs
  };

  /// `device` must outlive this object, which is its only user. Port * in `endpoint` lets the
  /// system choose. The device is read at `rate`, Hz, 1 to 100000. With `keys`, only an operator
  /// gets the device; without, any client does. Throws Error if it cannot listen, and Error (bad
  /// input) for a rate out of range.
  DeviceServer(HapticDevice& device, const std::string& endpoint, double rate = 1000,
               const std::optional<KeyFolder>& keys = std::nullopt);

  /// Returns the endpoint, with the port that was chosen.
  const std::string& endpoint() const { return endpoint_; }
  State state() const;

 private:
  using Clock = std::chrono::steady_clock;

  // On the server's thread.
  void run(const std::stop_token& stop, double rate);
  void turn();
  void handle(const IncomingDeviceMessage& incoming);
  void refuse(const std::string& peer, const std::string& why);
  void greet(const std::string& peer, const wire::DeviceGreeting& greeting);
  void follow(const wire::DeviceForce& force);
  void release();
  void sendReading(const DeviceReading& reading);
  void count(std::uint64_t State::*number);
  /// Returns the time when that reading was sent; nothing if it never was, or is older than the
  /// longest validity of a force.
  std::optional<Clock::time_point> sentAt(std::uint64_t reading) const;

  HapticDevice& device_;
  const DeviceProfile profile_;
  zmq::context_t context_;
  std::optional<ZapHandler> zap_handler_;  ///< before the socket, which is destroyed first
  zmq::socket_t socket_;
  std::string endpoint_;

  std::string holder_;  ///< routing id; empty: free
  Clock::time_point last_heard_, valid_until_, last_trouble_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  bool pushing_ = false;  ///< force_ is valid
  std::uint64_t last_force_ = 0, sequence_ = 0;
  /// Times of the last readings, the last of which has the number sequence_.
  std::deque<Clock::time_point> sent_;
  std::string trouble_;

  mutable std::mutex mutex_;
  State state_;          ///< guarded by mutex_
  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
