#include "viewer/devices/device_wire.hpp"

#include <cmath>
#include <iterator>
#include <vector>
#include <zmq_addon.hpp>

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Length of a queue in messages, enough for a few milliseconds. A full queue drops new messages.
constexpr int queue_length = 8;
constexpr std::int64_t longest_message = 4096;

void setDeviceOptions(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::sndhwm, queue_length);
  socket.set(zmq::sockopt::rcvhwm, queue_length);
  socket.set(zmq::sockopt::maxmsgsize, longest_message);
  socket.set(zmq::sockopt::heartbeat_ivl, 500);
  socket.set(zmq::sockopt::heartbeat_timeout, 1500);
}

}  // namespace

zmq::socket_t makeDeviceRouter(zmq::context_t& context) {
  zmq::socket_t socket = makeRouter(context);
  setDeviceOptions(socket);
  return socket;
}

zmq::socket_t makeDeviceDealer(zmq::context_t& context) {
  zmq::socket_t socket = makeDealer(context);
  setDeviceOptions(socket);
  socket.set(zmq::sockopt::reconnect_ivl, 50);
  socket.set(zmq::sockopt::reconnect_ivl_max, 500);
  return socket;
}

bool sendDeviceMessage(zmq::socket_t& socket, std::string_view peer,
                       const wire::DeviceMessage& message) {
  return sendBytes(socket, peer, message.SerializeAsString()) == Sent::yes;
}

std::optional<IncomingDeviceMessage> receiveDeviceMessage(zmq::socket_t& socket, bool router) {
  std::vector<zmq::message_t> frames;
  try {
    const auto received = repeatWhenInterrupted([&] {
      return zmq::recv_multipart(socket, std::back_inserter(frames), zmq::recv_flags::dontwait);
    });
    if (!received) return std::nullopt;
  } catch (const zmq::error_t& error) {
    throw failure("ZeroMQ receive: {}", error.what());
  }
  IncomingDeviceMessage incoming;
  if (router) incoming.peer = frames.front().to_string();
  zmq::message_t& body = frames.back();
  if (router) incoming.key = senderOf(body);
  const std::size_t expected = router ? 2 : 1;
  if (frames.size() != expected ||
      !incoming.message.ParseFromArray(body.data(), static_cast<int>(body.size())))
    incoming.message.Clear();
  return incoming;
}

std::optional<DeviceProfile> profileOf(const wire::DeviceHello& hello) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0; };
  if (!positive(hello.max_force()) || !positive(hello.max_stiffness()) ||
      !positive(hello.workspace_radius()))
    return std::nullopt;
  return DeviceProfile{"network", hello.max_force(), hello.max_stiffness(),
                       hello.workspace_radius()};
}

Eigen::Vector3d shortened(const Eigen::Vector3d& force, double max_force) {
  const double length = force.norm();
  return length > max_force ? (force * (max_force / length)).eval() : force;
}

}  // namespace palpate
