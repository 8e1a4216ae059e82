#include "viewer/devices/device_command.hpp"

#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <thread>
#include <utility>

#include "common/wire/wire.hpp"
#include "viewer/devices/device_choice.hpp"
#include "viewer/devices/device_server.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto look_interval = 100ms;

/// State of a lent device as it was last logged.
struct Told {
  DeviceServer::State state;
  std::string trouble;
};

/// Logs how the state has changed since the last call.
void look(const HapticDevice& device, const DeviceServer& server, Told& told) {
  const DeviceServer::State state = server.state(), last = std::exchange(told.state, state);
  if (!state.fault.empty()) throw failure("the device server stopped: {}", state.fault);
  if (state.held != last.held)
    spdlog::info("{}", state.held ? "a simulator connected to the device"
                                  : "the simulator released the device");
  if (state.lapses > last.lapses)
    spdlog::warn("no valid force from the simulator; zero force until one arrives");
  if (state.outdated > last.outdated)
    spdlog::warn("{} forces arrived too late and were ignored; check the network",
                 state.outdated - last.outdated);
  if (state.garbage > last.garbage)
    spdlog::warn("{} invalid messages were ignored", state.garbage - last.garbage);
  const std::string trouble = device.trouble();
  if (trouble == std::exchange(told.trouble, trouble)) return;
  trouble.empty() ? spdlog::info("{} is ready", device.name()) : spdlog::warn("{}", trouble);
}

}  // namespace

void DeviceCommandOptions::addTo(CLI::App& app) {
  endpoint = default_device_endpoint;
  app.add_option("--listen", endpoint, "Address for the simulator, tcp://HOST:PORT")
      ->capture_default_str();
  app.add_option("--device", device, deviceHelp(false))->capture_default_str();
  app.add_option("--rate", rate, "Readings per second")
      ->check(CLI::Range(1.0, 1e5))
      ->capture_default_str();
  keys.addTo(app, "Require no keys: anyone who reaches the port can push the hand");
  app.footer(
      "On the other machine: palpate view ... --device tcp://HOST:PORT, with a key allowed\n"
      "here as operator. The force is zero whenever the simulator is silent.\n"
      "Exit codes: 1 failed, 2 wrong usage, 130 interrupted.");
}

ExitCode serveDevice(const DeviceCommandOptions& options) {
  checkEndpoint(options.endpoint);
  const std::optional<KeyFolder> keys = options.keys.keys();
  // Catch Ctrl-C before opening the device, so that the program never ends with a force applied.
  catchInterrupts();
  DeviceContext context;
  context.period = 1 / options.rate;
  const auto device = openDevice(options.device, context);
  const DeviceServer server(*device, options.endpoint, options.rate, keys);
  spdlog::info("{} is available at {}; press Ctrl-C to stop", device->name(), server.endpoint());
  for (Told told; !interrupted(); std::this_thread::sleep_for(look_interval))
    look(*device, server, told);
  return ExitCode::interrupted;
}

const Verb device_verb = {"device", "Lend a haptic device to a simulator on another machine",
                          prepareVerb<DeviceCommandOptions, serveDevice>};

}  // namespace palpate
