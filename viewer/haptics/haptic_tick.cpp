#include "viewer/haptics/haptic_tick.hpp"

#include <algorithm>
#include <utility>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

const HapticModel& firstOf(const std::vector<const HapticModel*>& models) {
  PALPATE_ASSERT(!models.empty(), "at least one dataset must be given");
  PALPATE_ASSERT(models.front()->isPrepared(0), "the first method must be prepared");
  return *models.front();
}

/// Returns the options with the tick's period copied to guard and contact, and with a force limit
/// of at most that of the device.
TickOptions limited(TickOptions options, const HapticDevice& device) {
  options.guard.period = options.period;
  options.contact.period = options.period;
  const double most = device.profile().max_force;
  if (most > 0) options.guard.max_force = std::min(options.guard.max_force, most);
  options.guard.max_slew = slewOf(options.guard);
  options.guard.max_speed *= options.map.scale;
  return options;
}

Eigen::Matrix3Xd touchableVertices(const TouchSurface& surface) {
  std::vector<Eigen::Vector3d> found;
  for (std::size_t v = 0; v < surface.vertices().size(); ++v)
    if (!surface.sharesOf(static_cast<std::int32_t>(v)).empty())
      found.push_back(surface.vertices()[v]);
  return Eigen::Map<const Eigen::Matrix3Xd>(found.empty() ? nullptr : found.front().data(), 3,
                                            static_cast<Eigen::Index>(found.size()));
}

}  // namespace

WorkspaceMap workspaceFor(const HapticModel& model, const HapticDevice& device,
                          const DeviceProfile& limits) {
  WorkspaceMap map;
  const double radius = limits.workspace_radius;
  const Eigen::Matrix3Xd vertices = touchableVertices(model.surface());
  if (device.livesInScene() || !(radius > 0) || vertices.cols() == 0) return map;
  map.origin = 0.5 * (vertices.rowwise().minCoeff() + vertices.rowwise().maxCoeff());
  const double extent = (vertices.colwise() - map.origin).colwise().norm().maxCoeff();
  const double largest_displacement = std::ranges::max(
      mapped(model.spaces(), [](const SpaceTable& space) { return space.lattice.radius(); }));
  map.scale = std::max(1.0, (extent + largest_displacement) / radius);
  return map;
}

HapticTick::HapticTick(std::vector<const HapticModel*> models, HapticDevice& device,
                       const TickOptions& options)
    : models_(std::move(models)),
      device_(device),
      options_(limited(options, device)),
      contact_(firstOf(models_), options_.contact),
      guard_(options_.guard) {
  PALPATE_ASSERT(options_.period > 0, "the period of a tick must be positive");
  PALPATE_ASSERT(options_.map.scale > 0, "the scale from device to scene must be positive");
  state_.tool = options_.map.origin;
}

const HapticState& HapticTick::run(bool late) noexcept {
  ++state_.tick;
  state_.time = static_cast<double>(state_.tick) * options_.period;
  state_.reading = device_.read();
  const bool lost = state_.reading.status == DeviceStatus::lost;
  const bool away = state_.reading.status == DeviceStatus::away;
  // A lost device has no position, whatever its reading contains, and contact ends.
  const Eigen::Vector3d tool =
      lost || away ? nowhere() : options_.map.toScene(state_.reading.position);
  if (tool.allFinite()) state_.tool = tool;
  moveHold();

  const GuardInput input = {.tool = tool,
                            .touch = contact_.update(tool, (state_.reading.buttons & 1U) == 0),
                            .held = state_.reading.held,
                            .fresh = away || state_.reading.status == DeviceStatus::fresh,
                            .lost = lost,
                            .away = away,
                            // A lost device is halted. The tick in which it returns is late.
                            .late = late && !lost};
  const GuardedForce guarded = guard_.limit(input);

  state_.touch = input.touch;
  if (state_.hold) state_.hold_force = options_.contact.live->holdForce();
  state_.force = guarded.force;
  state_.guards = guarded.guards;
  state_.passivity = guarded.passivity;
  device_.write(options_.map.toDevice(guarded.force));
  return state_;
}

void HapticTick::moveHold() noexcept {
  state_.hold.reset();
  state_.hold_force = {};
  if (options_.contact.live == nullptr) return;
  const std::span<const std::optional<Hold>>& holds = options_.holds;
  if (contact_.follows()) {
    if (holds.empty())
      state_.hold = left_;
    else if (state_.tick <= holds.size())
      state_.hold = holds[state_.tick - 1];
  }
  options_.contact.live->setHold(state_.hold);
}

/// Two fingers cannot be at one place, so the hand must touch the body again from outside.
void HapticTick::leaveOrLetGo() noexcept {
  const Touch& touch = contact_.touch();
  if (left_) return left_.reset();
  if (!touch.touching || !contact_.follows()) return;
  left_ = {touch.anchor_position, touch.displacement};
  contact_.release();
}

void HapticTick::obey(const HapticCommand& command) noexcept {
  if (command.kind == HapticCommand::Kind::release) return contact_.release();
  if (command.kind == HapticCommand::Kind::hold) return leaveOrLetGo();
  const auto number = static_cast<std::size_t>(command.model);  // huge if negative
  if (command.kind == HapticCommand::Kind::replace) {
    if (number >= models_.size() || command.replacement == nullptr) return;
    contact_.replace(*std::exchange(models_[number], command.replacement), *command.replacement);
    state_.method = static_cast<std::int32_t>(contact_.method());
    return;
  }
  const auto method = static_cast<std::size_t>(command.method);
  if (number >= models_.size() || !models_[number]->isPrepared(method)) return;
  contact_.use(*models_[number], method);
  // The touch belongs to the previous model. A frame that is drawn before the next run() must not
  // combine this touch with the new model.
  state_.touch = {};
  state_.model = command.model;
  state_.method = command.method;
}

}  // namespace palpate
