#include "viewer/devices/device_wire.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

/// Messages in a queue: a few milliseconds, after which the newest is dropped.
constexpr int queue_length = 8;
constexpr std::int64_t longest_message = 4096;

void setDeviceOptions(zmq::socket_t& socket) {
  socket.set(zmq::sockopt::sndhwm, queue_length);
  socket.set(zmq::sockopt::rcvhwm, queue_length);
  socket.set(zmq::sockopt::maxmsgsize, longest_message);
  socket.set(zmq::sockopt::heartbeat_ivl, 500);
  socket.set(zmq::sockopt::heartbeat_timeout, 1500);
}

template <class Call>
auto repeatWhenInterrupted(Call call) {
  for (;;) {
    try {
      return call();
    } catch (const zmq::error_t& error) {
      if (error.num() != EINTR) throw;
    }
  }
}

bool receiveFrame(zmq::socket_t& socket, zmq::message_t& frame) {
  return repeatWhenInterrupted(
      [&] { return socket.recv(frame, zmq::recv_flags::dontwait).has_value(); });
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
  const std::string bytes = message.SerializeAsString();
  try {
    return repeatWhenInterrupted([&] {
      if (!peer.empty() && !socket.send(zmq::const_buffer(peer.data(), peer.size()),
                                        zmq::send_flags::dontwait | zmq::send_flags::sndmore))
        return false;
      return socket.send(zmq::const_buffer(bytes.data(), bytes.size()), zmq::send_flags::dontwait)
          .has_value();
    });
  } catch (const zmq::error_t& error) {
    if (error.num() == EHOSTUNREACH) return false;
    throw failure("ZeroMQ send: {}", error.what());
  }
}

std::optional<IncomingDeviceMessage> receiveDeviceMessage(zmq::socket_t& socket, bool router) {
  IncomingDeviceMessage incoming;
  bool intact = true;
  int bodies = 0;
  zmq::message_t frame;
  try {
    bool more = true;
    for (int number = router ? 0 : 1; more; ++number) {
      if (!receiveFrame(socket, frame)) return std::nullopt;
      more = frame.more();
      if (number == 0) {
        incoming.peer = frame.to_string();
        continue;
      }
      ++bodies;
      intact =
          intact && incoming.message.ParseFromArray(frame.data(), static_cast<int>(frame.size()));
    }
  } catch (const zmq::error_t& error) {
    throw failure("ZeroMQ receive: {}", error.what());
  }
  if (!intact || bodies != 1) incoming.message.Clear();
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
