#include "viewer/devices/haply_message.hpp"

#include <nlohmann/json.hpp>

namespace palpate {
namespace {

using nlohmann::json;

/// Returns a member of a JSON object; null if the member is missing.
const json& member(const json& value, const char* key) {
  static const json none;
  if (!value.is_object()) return none;
  const auto found = value.find(key);
  return found == value.end() ? none : *found;
}

/// Converts the service's axes (x right, y forward, z up) to ours (x right, y up, z toward the
/// operator).
Eigen::Vector3d toOurAxes(const Eigen::Vector3d& v) { return {v.x(), v.z(), -v.y()}; }
Eigen::Vector3d toServiceAxes(const Eigen::Vector3d& v) { return {v.x(), -v.z(), v.y()}; }

bool readVector(const json& value, Eigen::Vector3d& vector) {
  const json &x = member(value, "x"), &y = member(value, "y"), &z = member(value, "z");
  if (!x.is_number() || !y.is_number() || !z.is_number()) return false;
  vector = {x.get<double>(), y.get<double>(), z.get<double>()};
  return true;
}

/// Returns the button bits of the first VerseGrip: a, b and c if wireless, one button if wired.
std::uint32_t buttonsIn(const json& message) {
  std::uint32_t bits = 0;
  const auto first = [&](const char* key) -> const json& {
    const json& grips = member(message, key);
    return grips.is_array() && !grips.empty() ? member(grips.front(), "state") : member(json(), "");
  };
  const json& buttons = member(first("wireless_verse_grip"), "buttons");
  const char* const names[] = {"a", "b", "c"};
  for (unsigned bit = 0; bit < 3; ++bit)
    if (member(buttons, names[bit]) == true) bits |= 1U << bit;
  if (member(first("verse_grip"), "button") == true) bits |= 1;
  return bits;
}

std::string troubleIn(const json& status, const std::string& id) {
  if (member(status, "power_supply") == false)
    return "Inverse3 " + id + " has no power and renders no force: connect its power supply";
  if (member(status, "calibrated") == false)
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
  const json& devices = member(message, "inverse3");
  if (!devices.is_array()) return state;
  for (const json& device : devices) {
    const json& name = member(device, "device_id");
    if (!name.is_string()) continue;
    if (!id.empty() && name != id) {
      state.id += (state.id.empty() ? "" : ", ") + name.get<std::string>();
      continue;
    }
    state.id = name;
    Eigen::Vector3d position;
    if (!readVector(member(member(device, "state"), "cursor_position"), position)) {
      // The device is listed, so the connection stays open.
      state.kind = HaplyState::Kind::malformed;
      return state;
    }
    state.kind = HaplyState::Kind::reading;
    state.reading = {toOurAxes(position), buttonsIn(message), DeviceStatus::fresh};
    state.trouble = troubleIn(member(device, "status"), state.id);
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
