#include "tests/fuzz/frames.hpp"
#include "viewer/devices/device_wire.hpp"

namespace palpate::fuzz {
namespace {

/// The first byte selects the receiver; the frames of one message follow.
void readDeviceMessage(std::string_view bytes) {
  Choices choices(bytes);
  const bool router = choices.oneOf(2) == 1;
  static SocketPair sockets;
  sockets.send(choices);
  while (const auto incoming = receiveDeviceMessage(sockets.receiver(), router)) {
    const wire::DeviceMessage& message = incoming->message;
    if (const auto profile = profileOf(message.hello()))
      require(profile->max_force > 0, "a device without a force is accepted");
    const Eigen::Vector3d force = vectorOf(message.force());
    if (force.allFinite())
      require(!(shortened(force, 3.3).norm() > 3.3001), "a force is longer than it may be");
  }
}

std::string deviceFrame(const wire::DeviceMessage& message) {
  Script script;
  script.op(0).putBytes(message.SerializeAsString());
  return script.text();
}

std::vector<std::string> deviceSeeds() {
  wire::DeviceMessage hello, reading, force;
  hello.mutable_hello()->set_protocol(device_protocol);
  hello.mutable_hello()->set_name("device");
  hello.mutable_hello()->set_max_force(3.3);
  hello.mutable_hello()->set_max_stiffness(400);
  hello.mutable_hello()->set_workspace_radius(0.1);
  reading.mutable_reading()->set_sequence(7);
  reading.mutable_reading()->set_trouble("hot");
  setVector(*reading.mutable_reading(), {0.1, -0.2, 0.3});
  force.mutable_force()->set_valid_for_s(0.02);
  setVector(*force.mutable_force(), {1e300, -3, 0});
  Script routed;
  routed.op(1).putBytes("peer").putBytes(force.SerializeAsString());
  return {deviceFrame(hello), deviceFrame(reading), deviceFrame(force), routed.text()};
}

const Registration device_message_fuzzer({"device_message", readDeviceMessage, deviceSeeds});

}  // namespace
}  // namespace palpate::fuzz
