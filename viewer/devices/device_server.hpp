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

/// Lends a device to simulators on other machines (NetworkDevice), one simulator at a time.
///
/// A thread of its own reads the device at `rate`, sends each reading to the client that holds the
/// device, and writes the newest force of that client to the device. The client is not trusted:
/// - A force that is not finite is ignored. A force above the device's limit is scaled down to it.
/// - Each force states how long it is valid. This time begins when the server sends the reading
///   that the force answers. A force that arrives after that time is ignored, and the device gets
///   zero while no force is valid.
/// - A client that is silent for a second loses the device, and the next client can have it.
///
/// At the end the server writes a force of zero.
class DeviceServer {
 public:
  struct State {
    bool held = false;           ///< a client has the device
    std::uint64_t forces = 0;    ///< number of accepted forces
    std::uint64_t garbage = 0;   ///< number of invalid messages and invalid forces
    std::uint64_t outdated = 0;  ///< number of forces that arrived too late
    std::uint64_t lapses = 0;    ///< number of times that the force expired and was set to zero
    std::string fault;           ///< reason why the thread ended; empty while it runs
  };

  /// `device` must outlive this object, and nothing else may use it. The port * in `endpoint` lets
  /// the system choose a port. `rate` is the number of readings per second, 1 to 100000 Hz. With
  /// `keys`, only a client with an operator's key gets the device; without keys, any client does.
  /// Throws Error if the server cannot listen.
  DeviceServer(HapticDevice& device, const std::string& endpoint, double rate = 1000,
               const std::optional<KeyFolder>& keys = std::nullopt);

  /// Returns the endpoint. It contains the actual port.
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
  /// Returns the time when the reading with this number was sent. Returns nullopt if no such
  /// reading was sent, or if it was sent longer ago than a force can be valid.
  std::optional<Clock::time_point> sentAt(std::uint64_t reading) const;

  HapticDevice& device_;
  const DeviceProfile profile_;
  zmq::context_t context_;
  std::optional<ZapHandler> zap_handler_;  ///< declared before the socket, so that it is destroyed
                                           ///< after it
  zmq::socket_t socket_;
  std::string endpoint_;

  std::string holder_;  ///< routing id of the client that holds the device; empty if the device is
                        ///< free
  Clock::time_point last_heard_, valid_until_, last_trouble_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  bool pushing_ = false;  ///< force_ is valid
  std::uint64_t last_force_ = 0, sequence_ = 0;
  /// Times when the last readings were sent. The newest time belongs to reading number sequence_.
  std::deque<Clock::time_point> sent_;
  std::string trouble_;

  mutable std::mutex mutex_;
  State state_;          ///< guarded by mutex_
  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
