#include "viewer/devices/network_device.hpp"

#include "common/base/error.hpp"
#include "common/base/program.hpp"
#include "common/base/text.hpp"
#include "common/wire/wire.hpp"
#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto poll_interval = 1ms;
constexpr auto greeting_interval = 100ms;
/// One force is sent for each reading. If no readings arrive, forces are sent at this interval.
constexpr auto force_interval = 5ms;
constexpr auto farewell_time = 100ms;

/// Creates a context. With `real_time`, its threads get real-time priority, because all messages
/// pass through them. ZeroMQ aborts the program if the system refuses the priority, so the function
/// first checks whether the system grants it.
zmq::context_t contextFor(bool real_time) {
  zmq::context_t context(1);
  if (!real_time || refusalOfPriority(device_priority) != 0) return context;
  context.set(zmq::ctxopt::thread_sched_policy, SCHED_FIFO);
  context.set(zmq::ctxopt::thread_priority, device_priority);
  return context;
}

}  // namespace

NetworkDevice::NetworkDevice(NetworkDeviceOptions options)
    : options_(std::move(options)),
      context_(contextFor(options_.real_time)),
      socket_(makeDeviceDealer(context_)),
      handshakes_(context_, socket_),
      max_force_(options_.fallback.max_force) {
  traits_ = {.profile = options_.fallback, .has_buttons = true};
  if (options_.keys) proveAsClient(socket_, *options_.keys, options_.endpoint);
  if (const std::string trouble = connectDealer(socket_, options_.endpoint); !trouble.empty())
    throw failure("{}: {}", options_.endpoint, trouble);
  connection_trouble_ = fmt::format(
      "no device answers at {}: start one there with palpate device --listen", options_.endpoint);
  tellTrouble();
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
  std::unique_lock lock(mutex_);
  answered_.wait_for(lock, options_.wait, [&] { return hello_.has_value(); });
  // The limits and the frame are fixed from now on, because the loop relies on them.
  settled_ = true;
  if (!hello_) return;
  traits_ = {*profileOf(*hello_), hello_->lives_in_scene(), hello_->has_buttons()};
}

std::string NetworkDevice::name() const {
  const std::lock_guard lock(mutex_);
  return hello_ ? fmt::format("{} at {}", printable(hello_->name()), options_.endpoint)
                : options_.endpoint;
}

void NetworkDevice::run(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested()) turn();
    sayFarewell();
  } catch (const std::exception& error) {
    exchange_->setTrouble(
        fmt::format("{}: {}; the device is no longer used", options_.endpoint, error.what()));
  }
}

void NetworkDevice::turn() {
  waitForMessages(socket_, poll_interval);
  const std::uint64_t before = last_reading_;
  while (const auto incoming = receiveDeviceMessage(socket_, false)) handle(incoming->message);
  if (const std::string trouble = handshakes_.trouble(); !trouble.empty())
    connection_trouble_ = fmt::format("{}: {}", options_.endpoint, trouble);
  const auto now = Clock::now();
  if (connected_ && now - last_heard_ > DeviceExchange::silence) {
    connected_ = false;
    connection_trouble_ = fmt::format("{} has been silent for more than {} ms; waiting for it",
                                      options_.endpoint, DeviceExchange::silence.count());
  }
  if (!connected_ && now - last_greeting_ > greeting_interval) greet();
  if (connected_ && (last_reading_ != before || now - last_force_ > force_interval)) sendForce();
  tellTrouble();
}

void NetworkDevice::handle(const wire::DeviceMessage& message) {
  switch (message.body_case()) {
    case wire::DeviceMessage::kHello: return accept(message.hello());
    case wire::DeviceMessage::kRefused:
      connection_trouble_ = fmt::format("{} refused the connection: {}", options_.endpoint,
                                        printable(message.refused().reason(), longest_reason));
      return;
    case wire::DeviceMessage::kReading: {
      if (!greeted_) return;  // the device has not reported its limits
      const wire::DeviceReading& reading = message.reading();
      // Drop readings that are repeated or out of order: they do not show where the hand is now.
      if (reading.sequence() <= last_reading_) return;
      last_reading_ = reading.sequence();
      last_heard_ = Clock::now();
      connected_ = true;
      connection_trouble_.clear();
      device_trouble_ = printable(reading.trouble(), longest_reason);
      exchange_->deliver({vectorOf(reading), reading.buttons(),
                          reading.lost() ? DeviceStatus::lost : DeviceStatus::fresh});
      return;
    }
    default: ++garbage_;
  }
}

void NetworkDevice::accept(const wire::DeviceHello& hello) {
  const auto profile = profileOf(hello);
  if (hello.protocol() != device_protocol) {
    connection_trouble_ = fmt::format(
        "{} speaks version {} of the protocol, not {}: "
        "use the same version of palpate on both machines",
        options_.endpoint, hello.protocol(), device_protocol);
    return;
  }
  if (!profile) {
    ++garbage_;
    return;
  }
  {
    const std::lock_guard lock(mutex_);
    if (settled_ && hello.lives_in_scene() != traits_.lives_in_scene) {
      connection_trouble_ = fmt::format(
          "the device at {} answered too late, and its positions are in another frame than "
          "assumed: restart to use it",
          options_.endpoint);
      greeted_ = false;
      return;
    }
    hello_ = hello;
    // Respect the limit that the loop knows as well as the limit of this device.
    max_force_ =
        settled_ ? std::min(traits_.profile.max_force, profile->max_force) : profile->max_force;
  }
  answered_.notify_all();
  connected_ = greeted_ = true;
  last_reading_ = 0;
  last_heard_ = Clock::now();
  connection_trouble_.clear();
}

void NetworkDevice::greet() {
  wire::DeviceMessage message;
  message.mutable_greeting()->set_protocol(device_protocol);
  message.mutable_greeting()->set_version(version());
  sendDeviceMessage(socket_, "", message);
  last_greeting_ = Clock::now();
}

void NetworkDevice::sendForce() {
  wire::DeviceMessage message;
  wire::DeviceForce& force = *message.mutable_force();
  force.set_sequence(++forces_);
  setVector(force, shortened(exchange_->force(), max_force_));
  force.set_reading(last_reading_);
  force.set_valid_for_s(std::chrono::duration<double>(options_.valid).count());
  // If the queue is full, this force is dropped. The next one follows in a millisecond.
  sendDeviceMessage(socket_, "", message);
  last_force_ = Clock::now();
}

void NetworkDevice::sayFarewell() {
  wire::DeviceMessage message;
  message.mutable_farewell();
  sendDeviceMessage(socket_, "", message);
  socket_.set(zmq::sockopt::linger, static_cast<int>(farewell_time.count()));
}

void NetworkDevice::tellTrouble() {
  std::string sentence = connection_trouble_.empty() ? device_trouble_ : connection_trouble_;
  if (garbage_ > 0)
    sentence += fmt::format("{}{} invalid messages from {} were ignored",
                            sentence.empty() ? "" : "; ", garbage_, options_.endpoint);
  exchange_->setTrouble(sentence);
}

}  // namespace palpate
