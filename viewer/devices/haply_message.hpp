#pragma once

#include <string>
#include <string_view>

#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// The state of a device in one message of the service.
struct HaplyState {
  enum class Kind : std::uint8_t {
    reading,    ///< the device is listed, with a position
    no_device,  ///< the service lists no such device
    malformed   ///< invalid message
  } kind = Kind::malformed;
  std::string id;         ///< the device's; no_device: the listed ids, "049D, 04A1"
  DeviceReading reading;  ///< our axes, the service's origin
  std::string trouble;    ///< problem with calibration or power supply; empty: none
};
/// Parses a message. Never throws for any text. An empty `id` takes the first device.
HaplyState readHaplyState(std::string_view text, const std::string& id);

/// Returns the message that sets the force of a device (N, our axes).
std::string haplyForceMessage(const std::string& id, const Eigen::Vector3d& force);

}  // namespace palpate
