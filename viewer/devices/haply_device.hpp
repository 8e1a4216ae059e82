#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <thread>

#include "viewer/devices/device_exchange.hpp"

namespace palpate {

/// The Haply Inverse3: 4 N within 80 % of its workspace, 1 N/mm, a workspace of 460 x 510 x 230 mm
/// of which the largest ball is used (data sheet of the Inverse3). Its peak of 10 N is not: it
/// holds in few places.
inline constexpr DeviceProfile inverse3_profile{"inverse3", 4, 1000, 0.115};

struct HaplyDeviceOptions {
  std::string id = {};                ///< "049D", as the service shows it; empty: the first one
  std::string address = "127.0.0.1";  ///< of the Haply Inverse Service; a number, not a name
  std::uint16_t port = 10001;
  /// m, in our frame: where in the device's own frame, whose origin is on its mounting plate, the
  /// middle of the workspace is. Default: where the documentation of the service shows a resting
  /// cursor.
  std::array<double, 3> center = {0, 0.15, 0.12};
};

/// A Haply Inverse3 through the Haply Inverse Service, which must run on this machine.
///
/// The protocol is that of the service's versions 3.1 to 3.5 (docs.haply.co, Inverse SDK,
/// "WebSocket Protocol" and "Basis Permutation" of 3.5.x): JSON over ws://localhost:10001. The
/// service begins with an inventory and then answers every message of ours with the state of all
/// devices; every millisecond we send
///   {"inverse3":[{"device_id":ID,"commands":{"set_cursor_force":{"values":{"x":..,"y":..,"z":..}}}}]}
/// and read inverse3[].state.cursor_position {x,y,z} in metres, and the buttons of a VerseGrip. The
/// frame of the service is right-handed, x to the right, y forward, z up: our x, -z, y.
///
/// Lost when nothing came for 50 ms, or the service does not list the device any more; connects
/// again by itself.
class HaplyDevice : public ThreadedDevice {
 public:
  /// Does not wait for the service. Error (bad input) when the address is no number.
  explicit HaplyDevice(HaplyDeviceOptions options);

  std::string name() const override;
  std::string askForRealTime() override;

 private:
  void run(const std::stop_token& stop);
  void serve(const std::stop_token& stop);

  const HaplyDeviceOptions options_;
  const std::string place_;  ///< of the service, for a person
  std::jthread thread_;      ///< the last member: it ends before what it uses goes
};

}  // namespace palpate
