#pragma once

#include <string>
#include <string_view>

#include "viewer/haptics/haptic_device.hpp"

namespace palpate {

/// What one message of the service says about a device.
struct HaplyState {
  enum class Kind : std::uint8_t {
    reading,    ///< the device is there, and its position
    no_device,  ///< the service lists no such device
    malformed   ///< no message of the service
  } kind = Kind::malformed;
  std::string id;         ///< of the device; no_device: those that are listed, "049D, 04A1"
  DeviceReading reading;  ///< our axes, origin that of the service
  std::string trouble;    ///< not calibrated, no power supply
};
/// Never throws for any text. id: empty takes the first one.
HaplyState readHaplyState(std::string_view text, const std::string& id);

/// The message that makes the force of a device `force` (N, our axes).
std::string haplyForceMessage(const std::string& id, const Eigen::Vector3d& force);

}  // namespace palpate
