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

/// Raised with every incompatible change.
inline constexpr std::uint32_t device_protocol = 2;

/// Where `palpate device` listens when nothing is said.
inline constexpr const char* default_device_endpoint = "tcp://127.0.0.1:7412";

struct IncomingDeviceMessage {
  std::string peer;              ///< routing id on a ROUTER, empty on a DEALER
  wire::DeviceMessage message;   ///< BODY_NOT_SET when it made no sense: count it and drop it
  std::optional<PublicKey> key;  ///< whose it came under; nothing where no keys are asked for
};

/// ROUTER of a device, DEALER of its client: short queues, since only the newest matters, and
/// heartbeats that notice a dead connection within two seconds.
zmq::socket_t makeDeviceRouter(zmq::context_t& context);
zmq::socket_t makeDeviceDealer(zmq::context_t& context);

/// Without waiting; false when the peer is gone or does not read: the message is dropped then.
/// Error on any other ZeroMQ failure.
bool sendDeviceMessage(zmq::socket_t& socket, std::string_view peer,
                       const wire::DeviceMessage& message);
/// Without waiting; nothing when there is none.
std::optional<IncomingDeviceMessage> receiveDeviceMessage(zmq::socket_t& socket, bool router);

/// Positive, finite limits only; nothing otherwise. `name` of the profile is "network".
std::optional<DeviceProfile> profileOf(const wire::DeviceHello& hello);
/// The three numbers of a reading or a force, as they are.
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

/// `force`, at most `max_force` long.
Eigen::Vector3d shortened(const Eigen::Vector3d& force, double max_force);

}  // namespace palpate
