#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <zmq.hpp>

#include "common/keys/key_pair.hpp"
#include "proto/device.pb.h"
#include "viewer/haptics/haptic_device.hpp"

/// Messages of proto/device.proto over ZeroMQ (docs/devices.md).
namespace palpate {

/// Protocol version; raised with each incompatible change.
inline constexpr std::uint32_t device_protocol = 2;

/// The default address of `palpate device`.
inline constexpr const char* default_device_endpoint = "tcp://127.0.0.1:7412";

struct IncomingDeviceMessage {
  std::string peer;              ///< routing id on a ROUTER, empty on a DEALER
  wire::DeviceMessage message;   ///< BODY_NOT_SET if invalid: count and drop it
  std::optional<PublicKey> key;  ///< the sender's; nothing if no keys are required
};

/// Create the ROUTER of a device and the DEALER of its client. Their queues are short, since only
/// the newest message matters, and heartbeats detect a dead connection within two seconds.
zmq::socket_t makeDeviceRouter(zmq::context_t& context);
zmq::socket_t makeDeviceDealer(zmq::context_t& context);

/// Sends a message without waiting. Returns false, and drops it, if the peer is gone or does not
/// read. Throws Error on any other ZeroMQ failure.
bool sendDeviceMessage(zmq::socket_t& socket, std::string_view peer,
                       const wire::DeviceMessage& message);
/// Receives a message without waiting; nothing if there is none.
std::optional<IncomingDeviceMessage> receiveDeviceMessage(zmq::socket_t& socket, bool router);

/// Returns the profile in a hello, named "network"; nothing if a limit is not positive and finite.
std::optional<DeviceProfile> profileOf(const wire::DeviceHello& hello);
/// Returns the three components of a reading or a force, unchecked.
template <class Message>
Eigen::Vector3d vectorOf(const Message& message) {
  return {message.x(), message.y(), message.z()};
}
template <class Message>
void setVector(Message& message, const Eigen::Vector3d& v) {
  message.set_x(v.x());
  message.set_y(v.y());
  message.set_z(v.z());
}

/// Returns `force`, scaled down to the length `max_force` if it is longer.
Eigen::Vector3d shortened(const Eigen::Vector3d& force, double max_force);

}  // namespace palpate
