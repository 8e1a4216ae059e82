#include "viewer/devices/device_command.hpp"

#include <spdlog/spdlog.h>

#include <chrono>
#include <memory>
#include <thread>

#include "common/wire/wire.hpp"
#include "viewer/devices/device_choice.hpp"
#include "viewer/devices/device_server.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto look_interval = 100ms;

/// Tells what changed since it last looked.
class Watch {
 public:
  Watch(const HapticDevice& device, const DeviceServer& server)
      : device_(device), server_(server) {}

  void look() {
    const DeviceServer::State state = server_.state();
    if (!state.fault.empty()) throw failure("lending the device ended: {}", state.fault);
    if (state.held != last_.held)
      spdlog::info(
          "{}", state.held ? "a simulator took the device" : "the simulator gave the device back");
    if (state.lapses > last_.lapses)
      spdlog::warn("the forces of the simulator stayed away: zero force until they come again");
    if (state.outdated > last_.outdated)
      spdlog::warn("{} forces came too late and were ignored: the connection stalls",
                   state.outdated - last_.outdated);
    if (state.garbage > last_.garbage)
      spdlog::warn("{} messages made no sense and were ignored", state.garbage - last_.garbage);
    if (const std::string trouble = device_.trouble(); trouble != trouble_) {
      trouble_ = trouble;
      trouble.empty() ? spdlog::info("{} is ready", device_.name()) : spdlog::warn("{}", trouble);
    }
    last_ = state;
  }

 private:
  const HapticDevice& device_;
  const DeviceServer& server_;
  DeviceServer::State last_;
  std::string trouble_;
};

}  // namespace

ExitCode serveDevice(const DeviceCommandOptions& options) {
  checkEndpoint(options.endpoint);
  if (!isOnThisMachineOnly(options.endpoint) && !options.insecure)
    throw badInput(
        "--listen {}: anyone who reaches that port could push the hand, "
        "since there are no keys yet: listen on 127.0.0.1 and use a tunnel, "
        "or say --insecure on a network you trust",
        options.endpoint);
  catchInterrupts();
  DeviceContext context;
  context.period = 1 / options.rate;
  const auto device = openDevice(options.device, context);
  const DeviceServer server(*device, {options.endpoint, options.rate});
  spdlog::info("{} can be had at {}; Ctrl-C ends", device->name(), server.endpoint());
  Watch watch(*device, server);
  while (!interrupted()) {
    watch.look();
    std::this_thread::sleep_for(look_interval);
  }
  return ExitCode::interrupted;
}

Verb deviceVerb() {
  return {"device", "Lend a haptic device of this machine to a simulator on another",
          [](CLI::App& app) {
            auto options = std::make_shared<DeviceCommandOptions>();
            options->endpoint = default_device_endpoint;
            app.add_option("--listen", options->endpoint,
                           "Where the simulator connects, tcp://HOST:PORT")
                ->capture_default_str();
            app.add_option("--device", options->device, deviceHelp())->capture_default_str();
            app.add_option("--rate", options->rate, "Readings per second")
                ->check(CLI::Range(1.0, 1e5))
                ->capture_default_str();
            app.add_flag("--insecure", options->insecure,
                         "Listen beyond this machine although there are no keys");
            app.footer(
                "Over there: palpate view ... --device tcp://HOST:PORT. "
                "The force is zero whenever the simulator is silent.\n"
                "Exit codes: 1 failed, 2 wrong usage, 130 interrupted.");
            return std::function<ExitCode()>([options] { return serveDevice(*options); });
          }};
}

}  // namespace palpate
