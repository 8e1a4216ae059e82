#include "viewer/devices/device_server.hpp"

#include <cmath>

#include "common/base/error.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto holder_silence = 1s;
constexpr auto trouble_interval = 100ms;
constexpr auto longest_validity = 1s;
constexpr std::size_t longest_trouble = 500;

}  // namespace

DeviceServer::DeviceServer(HapticDevice& device, const DeviceServerOptions& options)
    : device_(device),
      profile_(device.profile()),
      context_(1),
      socket_(makeDeviceRouter(context_)) {
  if (!(options.rate >= 1) || !(options.rate <= 1e5))
    throw badInput("a device cannot be read {} times a second; give a rate from 1 to 100000",
                   options.rate);
  endpoint_ = bindRouter(socket_, options.endpoint);
  thread_ = std::thread(&DeviceServer::run, this, options.rate);
}

DeviceServer::~DeviceServer() {
  stopping_ = true;
  thread_.join();
}

DeviceServer::State DeviceServer::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void DeviceServer::run(double rate) {
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate));
  try {
    for (auto next = Clock::now(); !stopping_;) {
      turn();
      next = std::max(next + period, Clock::now());
      std::this_thread::sleep_until(next);
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    state_.fault = error.what();
  }
  device_.write(Eigen::Vector3d::Zero());
}

void DeviceServer::turn() {
  while (const auto incoming = receiveDeviceMessage(socket_, true)) handle(*incoming);
  const auto now = Clock::now();
  if (!holder_.empty() && now - last_heard_ > holder_silence) release();
  if (pushing_ && now > valid_until_) {
    pushing_ = false;
    const std::lock_guard lock(mutex_);
    ++state_.lapses;
  }
  const DeviceReading reading = device_.read();
  device_.write(pushing_ ? force_ : Eigen::Vector3d::Zero().eval());
  if (now - last_trouble_ > trouble_interval) {
    trouble_ = device_.trouble().substr(0, longest_trouble);
    last_trouble_ = now;
  }
  if (!holder_.empty()) sendReading(reading);
}

void DeviceServer::handle(const IncomingDeviceMessage& incoming) {
  const wire::DeviceMessage& message = incoming.message;
  const bool of_holder = !holder_.empty() && incoming.peer == holder_;
  if (of_holder) last_heard_ = Clock::now();
  switch (message.body_case()) {
    case wire::DeviceMessage::kGreeting:
      return greet(incoming.peer, message.greeting());
    case wire::DeviceMessage::kForce:
      if (of_holder) follow(message.force());
      return;
    case wire::DeviceMessage::kFarewell:
      if (of_holder) release();
      return;
    default: {
      const std::lock_guard lock(mutex_);
      ++state_.garbage;
    }
  }
}

void DeviceServer::greet(const std::string& peer, const wire::DeviceGreeting& greeting) {
  wire::DeviceMessage answer;
  if (greeting.protocol() != device_protocol) {
    answer.mutable_refused()->set_reason(fmt::format(
        "it speaks version {} of the protocol, you speak {}: use the same version of palpate",
        device_protocol, greeting.protocol()));
  } else if (!holder_.empty() && holder_ != peer) {
    answer.mutable_refused()->set_reason("another simulator holds the device");
  } else {
    release();
    wire::DeviceHello& hello = *answer.mutable_hello();
    hello.set_protocol(device_protocol);
    hello.set_name(device_.name());
    hello.set_max_force(profile_.max_force);
    hello.set_max_stiffness(profile_.max_stiffness);
    hello.set_workspace_radius(profile_.workspace_radius);
    hello.set_has_buttons(device_.hasButtons());
    hello.set_lives_in_scene(device_.livesInScene());
    holder_ = peer;
    last_heard_ = Clock::now();
    // Readings are numbered on: a force that was held back may not answer a newer one
    last_force_ = 0;
    const std::lock_guard lock(mutex_);
    state_.held = true;
  }
  sendDeviceMessage(socket_, peer, answer);
}

void DeviceServer::follow(const wire::DeviceForce& message) {
  const Eigen::Vector3d force = vectorOf(message);
  const std::chrono::duration<double> validity(message.valid_for_s());
  const bool valid = force.allFinite() && validity > 0s && validity <= longest_validity;
  const std::lock_guard lock(mutex_);
  if (!valid) {
    ++state_.garbage;
    return;
  }
  // The client counts on after a greeting of its own was repeated.
  if (message.sequence() <= last_force_) return;
  last_force_ = message.sequence();
  const auto answered = sentAt(message.reading());
  if (!answered || Clock::now() - *answered > validity) {
    ++state_.outdated;
    return;
  }
  force_ = shortened(force, profile_.max_force);
  pushing_ = true;
  valid_until_ = *answered + std::chrono::duration_cast<Clock::duration>(validity);
  ++state_.forces;
}

void DeviceServer::release() {
  holder_.clear();
  pushing_ = false;
  const std::lock_guard lock(mutex_);
  state_.held = false;
}

void DeviceServer::sendReading(const DeviceReading& reading) {
  wire::DeviceMessage message;
  wire::DeviceReading& content = *message.mutable_reading();
  content.set_sequence(++sequence_);
  const auto now = Clock::now();
  sent_.push_back(now);
  while (now - sent_.front() > longest_validity) sent_.pop_front();
  setVector(content, reading.position);
  content.set_buttons(reading.buttons);
  content.set_lost(reading.status == DeviceStatus::lost);
  content.set_trouble(trouble_);
  if (!sendDeviceMessage(socket_, holder_, message))
    return;  // the client does not read: it will miss it
  const std::lock_guard lock(mutex_);
  ++state_.readings;
}

std::optional<DeviceServer::Clock::time_point> DeviceServer::sentAt(std::uint64_t reading) const {
  if (reading > sequence_ || sequence_ - reading >= sent_.size()) return std::nullopt;
  return sent_[sent_.size() - 1 - static_cast<std::size_t>(sequence_ - reading)];
}

}  // namespace palpate
