#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <zmq.hpp>

#include "common/wire/curve.hpp"
#include "viewer/devices/device_exchange.hpp"
#include "viewer/devices/device_wire.hpp"

namespace palpate {

struct NetworkDeviceOptions {
  std::string endpoint;                ///< tcp://HOST:PORT or ipc://PATH of a DeviceServer
  std::optional<KeyFolder> keys = {};  ///< nothing: the server requires none
  /// Limits to use if no device answers within `wait`.
  DeviceProfile fallback = device_profiles.front();
  std::chrono::milliseconds wait{2000};
  /// Validity of a force, from the time its reading was sent. Without a valid force the device
  /// renders zero.
  std::chrono::milliseconds valid{50};
  bool real_time = false;  ///< real-time priority for the connection's threads
};

/// A device on another machine (docs/devices.md, DeviceServer). Readings come at the device's rate,
/// and each is answered with the newest force.
///
/// Lost after 50 ms without a reading; reconnects by itself. The server renders zero force when our
/// forces stop. Passes on NaN in a reading, which the force guard handles.
class NetworkDevice : public ThreadedDevice {
 public:
  /// Waits up to options.wait for the device's limits; without them it continues and reports this
  /// in trouble(). profile() and livesInScene() then stay as they are. If a device connects later,
  /// forces also respect its limit; it is not used if it lives in the other frame. Throws Error
  /// (bad input) for an invalid endpoint.
  explicit NetworkDevice(NetworkDeviceOptions options);

  std::string name() const override;
  std::string askForRealTime() override;

 private:
  using Clock = DeviceExchange::Clock;

  // On the device's thread.
  void run(const std::stop_token& stop);
  void turn();
  void handle(const wire::DeviceMessage& message);
  void accept(const wire::DeviceHello& hello);
  void greet();
  void sendForce();
  void sayFarewell();
  void tellTrouble();

  const NetworkDeviceOptions options_;

  mutable std::mutex mutex_;  ///< guards the members up to hello_
  std::condition_variable answered_;
  bool settled_ = false;                    ///< the limits are published and fixed
  std::optional<wire::DeviceHello> hello_;  ///< nothing: no device has reported its limits

  // Owned by the device's thread.
  zmq::context_t context_;
  zmq::socket_t socket_;
  HandshakeWatch handshakes_;
  bool greeted_ = false;    ///< the device has reported its limits
  bool connected_ = false;  ///< the device also sends readings
  double max_force_ = 0;    ///< N; smallest of the reported limits
  std::uint64_t last_reading_ = 0, forces_ = 0, garbage_ = 0;
  Clock::time_point last_heard_, last_greeting_, last_force_;
  std::string connection_trouble_, device_trouble_, told_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
