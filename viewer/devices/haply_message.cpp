#include "viewer/devices/haply_message.hpp"

#include <nlohmann/json.hpp>

namespace palpate {
namespace {

using nlohmann::json;

/// Returns the value at a JSON pointer; null if there is none.
const json& valueAt(const json& value, const std::string& path) {
  static const json none;
  const json::json_pointer pointer(path);
  return value.contains(pointer) ? value.at(pointer) : none;
}

/// Converts the service's axes (x right, y forward, z up) to ours (x right, y up, z toward the
/// operator).
Eigen::Vector3d toOurAxes(const Eigen::Vector3d& v) { return {v.x(), v.z(), -v.y()}; }
Eigen::Vector3d toServiceAxes(const Eigen::Vector3d& v) { return {v.x(), -v.z(), v.y()}; }

bool readVector(const json& value, Eigen::Vector3d& vector) {
  const json &x = valueAt(value, "/x"), &y = valueAt(value, "/y"), &z = valueAt(value, "/z");
  if (!x.is_number() || !y.is_number() || !z.is_number()) return false;
  vector = {x.get<double>(), y.get<double>(), z.get<double>()};
  return true;
}

/// Returns the button bits of the first VerseGrip: a, b and c if wireless, one button if wired.
std::uint32_t buttonsIn(const json& message) {
  constexpr std::array<std::pair<const char*, std::uint32_t>, 4> buttons = {
      {{"/wireless_verse_grip/0/state/buttons/a", 1},
       {"/wireless_verse_grip/0/state/buttons/b", 2},
       {"/wireless_verse_grip/0/state/buttons/c", 4},
       {"/verse_grip/0/state/button", 1}}};
  std::uint32_t bits = 0;
  for (const auto& [path, bit] : buttons)
    if (valueAt(message, path) == true) bits |= bit;
  return bits;
}

std::string troubleIn(const json& status, const std::string& id) {
  if (valueAt(status, "/power_supply") == false)
    return "Inverse3 " + id + " has no power and renders no force: connect its power supply";
  if (valueAt(status, "/calibrated") == false)
    return "Inverse3 " + id +
           " is not calibrated: put its arm into the inkwell, or follow the instructions of the "
           "Haply Hub";
  return {};
}

}  // namespace

HaplyState readHaplyState(std::string_view text, const std::string& id) {
  HaplyState state;
  const json message = json::parse(text, nullptr, false);
  if (!message.is_object()) return state;
  state.kind = HaplyState::Kind::no_device;
  const json& devices = valueAt(message, "/inverse3");
  if (!devices.is_array()) return state;
  for (const json& device : devices) {
    const json& name = valueAt(device, "/device_id");
    if (!name.is_string()) continue;
    if (!id.empty() && name != id) {
      state.id += (state.id.empty() ? "" : ", ") + name.get<std::string>();
      continue;
    }
    state.id = name;
    Eigen::Vector3d position;
    if (!readVector(valueAt(device, "/state/cursor_position"), position)) {
      // The device is listed, so the connection stays open.
      state.kind = HaplyState::Kind::malformed;
      return state;
    }
    state.kind = HaplyState::Kind::reading;
    state.reading = {toOurAxes(position), buttonsIn(message), DeviceStatus::fresh};
    state.trouble = troubleIn(valueAt(device, "/status"), state.id);
    return state;
  }
  return state;
}

std::string haplyForceMessage(const std::string& id, const Eigen::Vector3d& force) {
  const Eigen::Vector3d f = toServiceAxes(force);
  const json values = {{"x", f.x()}, {"y", f.y()}, {"z", f.z()}};
  const json device = {{"device_id", id},
                       {"commands", {{"set_cursor_force", {{"values", values}}}}}};
  return json{{"inverse3", json::array({device})}}.dump();
}

}  // namespace palpate
