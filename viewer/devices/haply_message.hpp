#pragma once

#include <string>
#include <string_view>

#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// State of a device in one message of the Haply Inverse Service.
struct HaplyState {
  enum class Kind : std::uint8_t {
    reading,    ///< the device is listed, with a position
    no_device,  ///< the service does not list the device
    malformed   ///< invalid message
  } kind = Kind::malformed;
  std::string id;         ///< id of the device; if no_device, the ids that are listed, such as
                          ///< "049D, 04A1"
  DeviceReading reading;  ///< along our axes, relative to the origin of the service's frame
  std::string trouble;    ///< problem with the calibration or the power supply; empty if there is
                          ///< none
};
/// Parses a message; `text` may be anything, and nothing is thrown. An empty `id` selects the first
/// device in the message.
HaplyState readHaplyState(std::string_view text, const std::string& id);

/// Returns the message that sets the force of a device (N, along our axes).
std::string haplyForceMessage(const std::string& id, const Eigen::Vector3d& force);

}  // namespace palpate
