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
  std::optional<KeyFolder> keys = {};  ///< nullopt if the server requires no keys
  /// Limits to use if no device answers within `wait`.
  DeviceProfile fallback = device_profiles.front();
  std::chrono::milliseconds wait{2000};
  /// Time for which a force is valid, counted from the moment when the server sent the reading that
  /// the force answers. Without a valid force the device renders zero.
  std::chrono::milliseconds valid{50};
  bool real_time = false;  ///< real-time priority for the connection's threads
};

/// A device on another machine (docs/devices.md, DeviceServer). The device sends readings at its
/// own rate, and each reading is answered with the newest force.
///
/// The device counts as lost after 50 ms without a reading. The connection is restored
/// automatically. The server renders zero force if it receives no more forces. NaN in a reading is
/// passed on; the force guard handles it.
class NetworkDevice : public ThreadedDevice {
 public:
  /// Waits up to options.wait for the limits of the device. If they do not arrive, the constructor
  /// returns all the same: trouble() reports it, and profile() and livesInScene() keep the fallback
  /// values. A device that connects later is used only if its frame is the same. Forces then also
  /// stay below its limit. Throws Error (bad input) for an invalid endpoint.
  explicit NetworkDevice(NetworkDeviceOptions options);

  std::string name() const override;

 private:
  using Clock = DeviceExchange::Clock;

  // On the device's thread.
  pthread_t thread() override { return thread_.native_handle(); }
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
  bool settled_ = false;                    ///< profile() and livesInScene() no longer change
  std::optional<wire::DeviceHello> hello_;  ///< nullopt if no device has reported its limits

  // Owned by the device's thread.
  zmq::context_t context_;
  zmq::socket_t socket_;
  HandshakeWatch handshakes_;
  bool greeted_ = false;    ///< the device has reported its limits
  bool connected_ = false;  ///< the device also sends readings
  double max_force_ = 0;    ///< N; smallest of all limits that apply
  std::uint64_t last_reading_ = 0, forces_ = 0, garbage_ = 0;
  Clock::time_point last_heard_, last_greeting_, last_force_;
  std::string connection_trouble_, device_trouble_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
