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
  std::string endpoint;  ///< tcp://HOST:PORT or ipc://PATH, where a DeviceServer listens
  std::optional<KeyFolder> keys = {};  ///< nothing: it asks for none
  /// Limits to go by when no device answered within `wait`.
  DeviceProfile fallback = device_profiles.front();
  std::chrono::milliseconds wait{2000};
  /// For how long a force stays valid at the far side, from the reading that it answers; then it
  /// renders zero.
  std::chrono::milliseconds valid{50};
  bool real_time = false;  ///< ask for real-time priority for the threads of the connection
};

/// A device on another machine (docs/devices.md, DeviceServer). Its readings come at the rate of
/// the device; every reading is answered with the newest force.
///
/// Lost when nothing came for 50 ms; it connects again by itself, and goes on. The far side lets go
/// by itself when our forces stay away. NaN in a reading is passed on: the force guard judges it.
class NetworkDevice : public ThreadedDevice {
 public:
  /// Waits up to options.wait for the device to say its limits; goes on without, and says so in
  /// trouble(). What profile() and livesInScene() said first holds: a device that comes later with
  /// less force gets no more than it can, one that lives in the other frame is not used. Error (bad
  /// input) for a wrong endpoint.
  explicit NetworkDevice(NetworkDeviceOptions options);

  std::string name() const override;
  std::string askForRealTime() override;

 private:
  using Clock = DeviceExchange::Clock;

  // On the thread of the device.
  void run(const std::stop_token& stop);
  void turn();
  void handle(const wire::DeviceMessage& message);
  void accept(const wire::DeviceHello& hello);
  void greet();
  void sendForce();
  void sayFarewell();
  void tellTrouble();

  const NetworkDeviceOptions options_;

  mutable std::mutex mutex_;  ///< of what follows
  std::condition_variable answered_;
  bool settled_ = false;                    ///< the limits are told and may not change any more
  std::optional<wire::DeviceHello> hello_;  ///< none: no device said its limits

  // Of the thread of the device.
  zmq::context_t context_;
  zmq::socket_t socket_;
  HandshakeWatch handshakes_;
  bool greeted_ = false;    ///< the device said its limits
  bool connected_ = false;  ///< and sends readings
  double max_force_ = 0;    ///< N, the least of all that was said
  std::uint64_t last_reading_ = 0, forces_ = 0, garbage_ = 0;
  Clock::time_point last_heard_, last_greeting_, last_force_;
  std::string connection_trouble_, device_trouble_, told_;

  std::jthread thread_;  ///< the last member: it ends before what it uses goes
};

}  // namespace palpate
