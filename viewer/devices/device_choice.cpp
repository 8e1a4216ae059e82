#include "viewer/devices/device_choice.hpp"

#include <array>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/nearest_word.hpp"
#include "viewer/devices/haply_device.hpp"
#include "viewer/devices/mouse_device.hpp"
#include "viewer/devices/network_device.hpp"
#include "viewer/devices/plugin_device.hpp"
#include "viewer/devices/replay_device.hpp"
#include "viewer/devices/virtual_hand.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

using Device = std::unique_ptr<HapticDevice>;

/// What stands before the first colon, and behind it.
struct Word {
  std::string_view kind;
  std::string rest;
};

Word split(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return {text, ""};
  return {text.substr(0, colon), std::string(text.substr(colon + 1))};
}

const HapticModel& modelFor(const char* device, const DeviceContext& context) {
  if (context.model == nullptr)
    throw badInput(
        "the device \"{}\" moves around a body, and there is none here: choose another{}", device,
        std::string_view(device) == "virtual" ? ", or give it a path: virtual:FILE" : "");
  return *context.model;
}

Device openVirtual(const Word& word, const DeviceContext& context) {
  HandPath path =
      word.rest.empty() ? touchPath(modelFor("virtual", context)) : readHandPath(word.rest);
  VirtualHandOptions options;
  options.period = context.period;
  return std::make_unique<VirtualHand>(std::move(path), options, context.profile);
}

Device openMouse(const Word&, const DeviceContext& context) {
  const Eigen::Vector3d start = touchPath(modelFor("mouse", context)).waypoints().front().position;
  MouseDeviceOptions options;
  options.period = context.period;
  return std::make_unique<MouseDevice>(start, options, context.profile);
}

Device openReplay(const Word& word, const DeviceContext& context) {
  if (word.rest.empty()) throw badInput("--device replay: name the recording: replay:FILE");
  return std::make_unique<ReplayDevice>(readRecording(word.rest), context.period, word.rest);
}

Device openHaply(const Word& word, const DeviceContext&) {
  HaplyDeviceOptions options;
  options.id = word.rest;
  return std::make_unique<HaplyDevice>(std::move(options));
}

Device openPlugin(const Word& word, const DeviceContext& context) {
  if (word.rest.empty())
    throw badInput("--device plugin: name the library: plugin:LIB.so or plugin:LIB.so:ID");
  const Word library = split(word.rest), device = split(library.rest);
  return std::make_unique<PluginDevice>(PluginDeviceOptions{
      std::string(library.kind), std::string(device.kind), device.rest, context.period});
}

struct Opener {
  std::string_view kind;
  Device (*open)(const Word& word, const DeviceContext& context);
  bool takes_rest;
};
constexpr std::array<Opener, 5> openers = {{{"virtual", openVirtual, true},
                                            {"mouse", openMouse, false},
                                            {"replay", openReplay, true},
                                            {"haply", openHaply, true},
                                            {"plugin", openPlugin, true}}};

Error unknown(const std::string& text, std::string_view kind) {
  std::array<std::string_view, openers.size()> kinds{};
  for (std::size_t i = 0; i < openers.size(); ++i) kinds[i] = openers[i].kind;
  const std::string_view near = nearestWord(kind, kinds);
  return badInput("--device {}: there is no such device{}; it can be {}", text,
                  near.empty() ? "" : fmt::format(" (did you mean {}?)", near), deviceHelp());
}

}  // namespace

const char* deviceHelp() {
  return "virtual, virtual:FILE, mouse, replay:FILE, tcp://HOST:PORT, haply, "
         "haply:ID or plugin:LIB.so[:ID]";
}

std::unique_ptr<HapticDevice> openDevice(const std::string& text, const DeviceContext& context) {
  if (text.starts_with("tcp://") || text.starts_with("ipc://"))
    return std::make_unique<NetworkDevice>(
        NetworkDeviceOptions{.endpoint = text, .fallback = context.profile});
  const Word word = split(text);
  for (const Opener& opener : openers)
    if (opener.kind == word.kind && (opener.takes_rest || word.rest.empty()))
      return opener.open(word, context);
  throw unknown(text, word.kind);
}

}  // namespace palpate
