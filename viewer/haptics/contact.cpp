#include "viewer/haptics/contact.hpp"

#include <utility>

#include "viewer/haptics/anchor_slide.hpp"
#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/live_touch.hpp"

namespace palpate {
namespace {

/// A tool inside the body that is at most this far from its surface, m, can still enter. At this
/// depth, rounding decides whether the tool is inside or outside.
constexpr double graze = 1e-6;

}  // namespace

Contact::Contact(const HapticModel& model, const ContactOptions& options)
    : model_(&model),
      options_(options),
      force_(options.live, options.live_model),
      last_tool_(nowhere()),
      state_(options.mode == ContactMode::glued ? State::ready : State::shut) {}

const Touch& Contact::update(const Eigen::Vector3d& tool, bool hold) noexcept {
  LiveTouch* const live = options_.live;
  if (live != nullptr) live->begin(options_.period);
  follow(tool, hold);
  ++updates_;
  if (live != nullptr)
    live->publish({static_cast<double>(updates_) * options_.period, touch_.touching && follows(),
                   touch_.anchor_position, touch_.displacement, touch_.force});
  return touch_;
}

void Contact::follow(const Eigen::Vector3d& tool, bool hold) noexcept {
  touch_.stepped = std::exchange(step_follows_, false);
  if (!tool.allFinite()) {
    end(touch_.stepped || !touch_.force.isZero(0),
        options_.mode == ContactMode::glued ? State::ready : State::shut);
    touch_.inside = false;
    last_tool_ = nowhere();
    return;
  }
  if (!last_tool_.allFinite()) last_tool_ = tool;

  if (state_ == State::touching && options_.mode == ContactMode::glued && !hold)
    end(touch_.stepped || !touch_.force.isZero(0), State::ready);
  if (state_ == State::touching) {
    const double force = touch_.force.norm(), stiffness = touch_.stiffness.norm();
    if (press(tool)) {
      last_tool_ = tool;
      return;
    }
    // The loss of the force is a step unless the tool's own motion explains it.
    end(touch_.stepped || force > 2 * stiffness * (tool - last_tool_).norm(), State::shut);
  }
  seek(tool, hold);
}

void Contact::seek(const Eigen::Vector3d& tool, bool hold) noexcept {
  const NearestPoint nearest = model_->surface().tree().nearest(tool, near_triangle_);
  near_triangle_ = nearest.triangle;
  touch_.gap = nearest.outside ? nearest.distance : -nearest.distance;
  if (options_.mode == ContactMode::glued) return seekGrip(tool, hold);
  if (!nearest.outside && state_ == State::ready) return seekEntry(tool, nearest);
  if (nearest.outside || nearest.distance <= graze) state_ = State::ready;
  last_tool_ = tool;
}

/// Finds the point of entry of a tool that was outside and is now inside.
void Contact::seekEntry(const Eigen::Vector3d& tool, const NearestPoint& nearest) noexcept {
  const Crossing crossing = model_->surface().tree().entry(last_tool_, tool);
  // Because of rounding, a tool on the surface can get inside without a crossing.
  SurfacePoint entry = nearest;
  if (crossing.triangle >= 0) entry = crossing;
  entry = model_->surface().preferTouchable(entry);
  if (model_->surface().touchable(entry.triangle)) {
    const double gap = touch_.gap;
    anchor_ = entry;
    offset_.setZero();
    if (press(tool)) {
      last_tool_ = tool;
      return;
    }
    end(touch_.stepped, State::ready);
    touch_.gap = gap;
    if (nearest.distance <= graze) return;
  }
  state_ = State::shut;
  last_tool_ = tool;
}

void Contact::seekGrip(const Eigen::Vector3d& tool, bool hold) noexcept {
  last_tool_ = tool;
  const NearestPoint nearest = model_->surface().nearestTouchable(tool);
  const bool near = nearest.distance <= options_.grab_distance;
  if (!hold || !near) state_ = State::ready;
  if (state_ != State::ready || !hold || !near) return;
  anchor_ = nearest;
  offset_ = tool - nearest.position;
  press(tool);
}

/// Computes the touch. Returns false if the tissue would pull back a tool that leaves; the caller
/// then ends the contact. A tool inside the body at rest stays in contact whatever the direction of
/// the force, because on a lobe that bends away the force no longer follows the normal at rest.
bool Contact::press(const Eigen::Vector3d& tool) noexcept {
  const TouchSurface& surface = model_->surface();
  const Eigen::Vector3d pressing = tool - offset_;
  force_.evaluateUnjudged(*model_, method_, anchor_, pressing - surface.position(anchor_));
  if (options_.mode == ContactMode::unilateral)
    slideAnchor(*model_, method_, options_, pressing, (tool - last_tool_).norm(), anchor_, force_);
  const Eigen::Vector3d displacement = pressing - surface.position(anchor_),
                        normal = surface.normal(anchor_);
  if (options_.mode == ContactMode::unilateral && displacement.dot(normal) >= 0 &&
      force_.force().dot(normal) <= 0 && surface.tree().nearest(tool, near_triangle_).outside)
    return false;
  force_.judge();
  describe(displacement);
  return true;
}

void Contact::describe(const Eigen::Vector3d& displacement) noexcept {
  static_cast<ForceSample&>(touch_) = force_.sum();
  touch_.touching = true;
  state_ = State::touching;
  touch_.anchor = anchor_;
  touch_.anchor_position = model_->surface().position(anchor_);
  touch_.normal = model_->surface().normal(anchor_);
  touch_.displacement = displacement;
  touch_.blend = force_.blend();
  const Eigen::Vector3d& face = model_->surface().faceNormal(anchor_.triangle);
  touch_.drive = force_.drive() - face.dot(force_.drive()) * face;
  touch_.followed = force_.followed();
  touch_.gap = 0;
}

void Contact::end(bool stepped, State next) noexcept {
  touch_ = {};
  touch_.stepped = stepped;
  state_ = next;
}

void Contact::release() noexcept {
  step_follows_ = step_follows_ || !touch_.force.isZero(0);
  end(false, State::shut);
  last_tool_ = nowhere();
}

void Contact::correctBy(LiveTouch* live, const HapticModel* live_model, double period) {
  release();
  options_.live = live;
  options_.live_model = live_model;
  options_.period = period;
  force_ = BlendedForce(live, live_model);
}

void Contact::use(const HapticModel& model, std::size_t method) noexcept {
  const bool same = sameSurface(model_->surface(), model.surface());
  const bool kept =
      state_ == State::touching && same && model.surface().touchable(anchor_.triangle);
  model_ = &model;
  method_ = method;
  if (state_ == State::touching && !kept) release();
  if (state_ == State::touching) step_follows_ = true;
  if (same) return;
  near_triangle_ = -1;
  if (options_.mode == ContactMode::unilateral) state_ = State::shut;
}

void Contact::replace(const HapticModel& old, const HapticModel& model) noexcept {
  if (options_.live_model == &old) {
    options_.live_model = &model;
    force_.correct(&model);
  }
  if (model_ == &old) use(model, model.isPrepared(method_) ? method_ : 0);
}

}  // namespace palpate
