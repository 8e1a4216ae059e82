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

inline constexpr const char* default_device_endpoint = "tcp://127.0.0.1:7412";

struct IncomingDeviceMessage {
  std::string peer;              ///< routing id of the sender if a ROUTER received the message;
                                 ///< empty on a DEALER
  wire::DeviceMessage message;   ///< BODY_NOT_SET if the message is invalid: count it and drop it
  std::optional<PublicKey> key;  ///< key of the sender; nullopt if no keys are required
};

/// Create the ROUTER socket of a device and the DEALER socket of its client. Their queues are
/// short, since only the newest message matters. Heartbeats detect a dead connection within two
/// seconds.
zmq::socket_t makeDeviceRouter(zmq::context_t& context);
zmq::socket_t makeDeviceDealer(zmq::context_t& context);

/// Sends a message without waiting. If the peer is gone or does not read its messages, drops the
/// message and returns false. Throws Error on any other ZeroMQ failure.
bool sendDeviceMessage(zmq::socket_t& socket, std::string_view peer,
                       const wire::DeviceMessage& message);
/// Receives a message without waiting. Returns nullopt if no message has arrived.
std::optional<IncomingDeviceMessage> receiveDeviceMessage(zmq::socket_t& socket, bool router);

/// Returns the limits in a hello message, as a profile named "network". Returns nullopt if a limit
/// is not positive and finite.
std::optional<DeviceProfile> profileOf(const wire::DeviceHello& hello);
/// Returns the three components of a reading or a force, without checking them.
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
