#include "viewer/devices/device_server.hpp"

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/wire/wire.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto holder_silence = 1s;
constexpr auto trouble_interval = 100ms;
constexpr auto longest_validity = 1s;
/// An honest client sends this number of messages in two seconds. More messages in a turn are a
/// flood.
constexpr int messages_per_turn = 2048;

}  // namespace

DeviceServer::DeviceServer(HapticDevice& device, const std::string& endpoint, double rate,
                           const std::optional<KeyFolder>& keys)
    : device_(device),
      profile_(device.profile()),
      context_(1),
      socket_(makeDeviceRouter(context_)) {
  if (keys) zap_handler_.emplace(context_, socket_, *keys);
  endpoint_ = bindRouter(socket_, endpoint);
  thread_ = std::jthread([this, rate](const std::stop_token& stop) { run(stop, rate); });
}

DeviceServer::State DeviceServer::state() const {
  const std::lock_guard lock(mutex_);
  return state_;
}

void DeviceServer::run(const std::stop_token& stop, double rate) {
  const auto period =
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / rate));
  try {
    for (auto next = Clock::now(); !stop.stop_requested();) {
      turn();
      next = std::max(next + period, Clock::now());
      std::this_thread::sleep_until(next);
    }
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    state_.fault = error.what();
  }
  // Always end with a force of zero, whatever ended the loop.
  device_.write(Eigen::Vector3d::Zero());
}

void DeviceServer::turn() {
  // Take all waiting messages, since only the newest force is used. In a flood, take a limited
  // number, so that the loop still notices in time when a force expires.
  for (int n = 0; n < messages_per_turn; ++n) {
    const auto incoming = receiveDeviceMessage(socket_, true);
    if (!incoming) break;
    handle(*incoming);
  }
  const auto now = Clock::now();
  if (!holder_.empty() && now - last_heard_ > holder_silence) release();
  if (pushing_ && now > valid_until_) {
    pushing_ = false;
    count(&State::lapses);
  }
  const DeviceReading reading = device_.read();
  device_.write(pushing_ ? force_ : Eigen::Vector3d::Zero().eval());
  if (now - last_trouble_ > trouble_interval) {
    trouble_ = printable(device_.trouble(), longest_reason);  // messages must be UTF-8
    last_trouble_ = now;
  }
  if (!holder_.empty()) sendReading(reading);
}

void DeviceServer::handle(const IncomingDeviceMessage& incoming) {
  const wire::DeviceMessage& message = incoming.message;
  const bool of_holder = !holder_.empty() && incoming.peer == holder_;
  if (zap_handler_ && !include(zap_handler_->rolesOf(incoming.key), Roles::system_operator)) {
    if (of_holder) release();
    return refuse(
        incoming.peer,
        "your key is not allowed to use this device; on the device's machine run: palpate key "
        "allow KEY operator");
  }
  if (of_holder) last_heard_ = Clock::now();
  switch (message.body_case()) {
    case wire::DeviceMessage::kGreeting: return greet(incoming.peer, message.greeting());
    case wire::DeviceMessage::kForce:
      if (of_holder) follow(message.force());
      return;
    case wire::DeviceMessage::kFarewell:
      if (of_holder) release();
      return;
    default: count(&State::garbage);
  }
}

void DeviceServer::refuse(const std::string& peer, const std::string& why) {
  wire::DeviceMessage answer;
  answer.mutable_refused()->set_reason(why);
  sendDeviceMessage(socket_, peer, answer);
}

void DeviceServer::greet(const std::string& peer, const wire::DeviceGreeting& greeting) {
  if (greeting.protocol() != device_protocol)
    return refuse(peer, fmt::format("its protocol version is {}, yours is {}: use the same version "
                                    "of palpate",
                                    device_protocol, greeting.protocol()));
  if (!holder_.empty() && holder_ != peer)
    return refuse(peer, "another simulator is using the device");
  // Release the device even if this client holds it: a greeting always begins a new session.
  release();
  holder_ = peer;
  last_heard_ = Clock::now();
  // The numbers of readings are not reset, so a delayed force cannot be taken for an answer to a
  // newer reading.
  last_force_ = 0;
  {
    const std::lock_guard lock(mutex_);
    state_.held = true;
  }
  wire::DeviceMessage answer;
  wire::DeviceHello& hello = *answer.mutable_hello();
  hello.set_protocol(device_protocol);
  hello.set_name(printable(device_.name()));
  hello.set_max_force(profile_.max_force);
  hello.set_max_stiffness(profile_.max_stiffness);
  hello.set_workspace_radius(profile_.workspace_radius);
  hello.set_has_buttons(device_.hasButtons());
  hello.set_lives_in_scene(device_.livesInScene());
  sendDeviceMessage(socket_, peer, answer);
}

void DeviceServer::follow(const wire::DeviceForce& message) {
  const Eigen::Vector3d force = vectorOf(message);
  const std::chrono::duration<double> validity(message.valid_for_s());
  const bool valid = force.allFinite() && validity > 0s && validity <= longest_validity;
  if (!valid) return count(&State::garbage);
  // Skip forces that arrive out of order. A client that greets again need not restart its numbers.
  if (message.sequence() <= last_force_) return;
  last_force_ = message.sequence();
  const auto answered = sentAt(message.reading());
  if (!answered || Clock::now() - *answered > validity) return count(&State::outdated);
  force_ = shortened(force, profile_.max_force);
  pushing_ = true;
  valid_until_ = *answered + std::chrono::duration_cast<Clock::duration>(validity);
  count(&State::forces);
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
  // The protocol has no status `away`. It is sent as lost: in both states there is no position.
  content.set_lost(reading.status == DeviceStatus::lost || reading.status == DeviceStatus::away);
  content.set_trouble(trouble_);
  // A client that does not read misses the message.
  sendDeviceMessage(socket_, holder_, message);
}

void DeviceServer::count(std::uint64_t State::*number) {
  const std::lock_guard lock(mutex_);
  ++(state_.*number);
}

std::optional<DeviceServer::Clock::time_point> DeviceServer::sentAt(std::uint64_t reading) const {
  PALPATE_ASSERT(sent_.size() <= sequence_, "every reading that is sent must be numbered");
  if (reading > sequence_ || sequence_ - reading >= sent_.size()) return std::nullopt;
  return sent_[sent_.size() - 1 - static_cast<std::size_t>(sequence_ - reading)];
}

}  // namespace palpate
