#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <thread>

#include "viewer/devices/device_exchange.hpp"

namespace palpate {

/// Limits of the Haply Inverse3 from its data sheet: 4 N within 80 % of its workspace, 1 N/mm. The
/// workspace of 460 x 510 x 230 mm is reduced to the largest ball that fits into it. The peak force
/// of 10 N is not used, because the device can render it in few places only.
inline constexpr DeviceProfile inverse3_profile{"inverse3", 4, 1000, 0.115};

struct HaplyDeviceOptions {
  std::string id = {};  ///< "049D", as the service shows it; empty: the first device
  std::uint16_t port = 10001;
  /// Middle of the workspace, along our axes, m. It is relative to the origin of the device's own
  /// frame, which lies on the mounting plate. The default is the position of the resting cursor in
  /// the documentation of the service.
  Eigen::Vector3d center = {0, 0.15, 0.12};
};

/// A Haply Inverse3, driven through the Haply Inverse Service on this machine.
///
/// Uses the protocol of service versions 3.1 to 3.5 (docs.haply.co, Inverse SDK, "WebSocket
/// Protocol" and "Basis Permutation" of 3.5.x): JSON over ws://localhost:10001. The service first
/// sends an inventory, then answers each of our messages with the state of all devices. Every
/// millisecond we send
///   {"inverse3":[{"device_id":ID,"commands":{"set_cursor_force":{"values":{"x":..,"y":..,"z":..}}}}]}
/// and read inverse3[].state.cursor_position {x,y,z} in metres, and the buttons of a VerseGrip. The
/// service's frame is right-handed: its x, y and z axes point to the right, forward and up, along
/// our x, -z and y axes.
///
/// The device counts as lost after 50 ms without an answer, or if the service no longer lists it.
/// The connection is restored automatically.
class HaplyDevice : public ThreadedDevice {
 public:
  /// Does not wait for the service.
  explicit HaplyDevice(HaplyDeviceOptions options);

  std::string name() const override;

 private:
  pthread_t thread() override { return thread_.native_handle(); }
  void run(const std::stop_token& stop);
  void serve(const std::stop_token& stop);

  const HaplyDeviceOptions options_;
  const std::string place_;  ///< URL of the service, for messages
  std::jthread thread_;      ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
