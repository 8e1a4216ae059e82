#include "viewer/devices/device_choice.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "common/base/error.hpp"
#include "common/base/text.hpp"
#include "common/wire/wire.hpp"
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

/// A word of --device: the part before its first colon and the part after it.
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
        "the device \"{}\" needs a body to touch, and none is loaded here: choose another{}",
        device, std::string_view(device) == "virtual" ? ", or give it a path: virtual:FILE" : "");
  return *context.model;
}

Device openVirtual(const Word& word, const DeviceContext& context) {
  HandPath path = word.rest.empty() ? touchPath(modelFor("virtual", context), context.hand_speed)
                                    : readHandPath(word.rest);
  return std::make_unique<VirtualHand>(std::move(path), context.period, context.profile);
}

Device openMouse(const Word&, const DeviceContext& context) {
  modelFor("mouse", context);  // the mouse moves only in the picture of a body
  return std::make_unique<MouseDevice>(context.period, context.profile);
}

Device openReplay(const Word& word, const DeviceContext& context) {
  return std::make_unique<ReplayDevice>(readRecording(word.rest), context.period, word.rest);
}

Device openHaply(const Word& word, const DeviceContext&) {
  return std::make_unique<HaplyDevice>(HaplyDeviceOptions{.id = word.rest});
}

Device openPlugin(const Word& word, const DeviceContext& context) {
  const Word library = split(word.rest), device = split(library.rest);
  return std::make_unique<PluginDevice>(PluginDeviceOptions{
      std::string(library.kind), std::string(device.kind), device.rest, context.period});
}

enum class Rest { none, optional, needed };  // whether a part after the colon may or must follow

struct Opener {
  std::string_view kind;
  Device (*open)(const Word& word, const DeviceContext& context);
  Rest rest;
  const char* missing = "";  // error text if the part after the colon is missing but needed
};
constexpr std::array<Opener, 5> openers = {
    {{"virtual", openVirtual, Rest::optional},
     {"mouse", openMouse, Rest::none},
     {"replay", openReplay, Rest::needed, "name the recording: replay:FILE"},
     {"haply", openHaply, Rest::optional},
     {"plugin", openPlugin, Rest::needed, "name the library: plugin:LIB.so or plugin:LIB.so:ID"}}};

Error unknown(const std::string& text, std::string_view kind, bool with_body) {
  const std::string_view near = nearestWord(kind, mapped(openers, &Opener::kind));
  std::string hint = near.empty() ? "" : fmt::format(" (did you mean {}?)", near);
  // A word such as "falcon" names no device, but a profile, whose limits the user may have wanted.
  if (std::ranges::find(device_words, kind) != device_words.end())
    hint = fmt::format(" (to use its limits: --profile {})", kind);
  return badInput("--device {}: unknown device{}; known: {}", text, hint, deviceHelp(with_body));
}

const Opener& openerOf(const std::string& text, const Word& word, bool with_body) {
  for (const Opener& opener : openers) {
    if (opener.kind != word.kind || (opener.rest == Rest::none && !word.rest.empty())) continue;
    if (opener.rest == Rest::needed && word.rest.empty())
      throw badInput("--device {}: {}", word.kind, opener.missing);
    return opener;
  }
  throw unknown(text, word.kind, with_body);
}

/// Returns whether a word is an endpoint, which is not split at its first colon.
bool isEndpoint(const std::string& text) {
  return text.starts_with("tcp://") || text.starts_with("ipc://");
}

}  // namespace

std::string deviceHelp(bool with_body) {
  return fmt::format("{}replay:FILE, tcp://HOST:PORT, haply, haply:ID or plugin:LIB.so[:ID]",
                     with_body ? "virtual, virtual:FILE, mouse, " : "virtual:FILE, ");
}

void checkDeviceWord(const std::string& text) {
  if (isEndpoint(text))
    checkEndpoint(text);
  else
    openerOf(text, split(text), true);
}

DeviceProfile smallerOf(const DeviceProfile& first, const DeviceProfile& second) {
  return {first.name, std::min(first.max_force, second.max_force),
          std::min(first.max_stiffness, second.max_stiffness),
          std::min(first.workspace_radius, second.workspace_radius)};
}

std::string doubtsOf(const DeviceProfile& profile) {
  constexpr double most_force = 100, least_radius = 0.005, most_radius = 2;
  if (profile.max_force <= most_force && profile.workspace_radius >= least_radius &&
      profile.workspace_radius <= most_radius)
    return {};
  return fmt::format(
      "it reports a largest force of {:g} N and a reach of {:g} m, which no haptic device has: "
      "check that its limits are in newtons and metres, or set limits with --profile",
      profile.max_force, profile.workspace_radius);
}

std::unique_ptr<HapticDevice> openDevice(const std::string& text, const DeviceContext& context) {
  if (isEndpoint(text))
    return std::make_unique<NetworkDevice>(NetworkDeviceOptions{.endpoint = text,
                                                                .keys = context.keys.keys(),
                                                                .fallback = context.profile,
                                                                .real_time = context.real_time});
  const Word word = split(text);
  return openerOf(text, word, context.model != nullptr).open(word, context);
}

}  // namespace palpate
