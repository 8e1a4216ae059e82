#include "viewer/picture/mouse_hand.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/base/index.hpp"
#include "viewer/haptics/hand_pace.hpp"
#include "viewer/picture/framed_sphere.hpp"

namespace palpate {
namespace {

constexpr double largest_share = 0.95;  // largest depth or pull, as a share of reach()
constexpr double notches = 50;          // notches of the wheel for the whole reach
constexpr double waiting_share = 0.03;  // distance of the waiting tool from the skin, as a share of
                                        // the body's radius
constexpr double lifted = 0.75;         // share of this distance to which a tool must come out
                                        // before it may go to another place
constexpr double fastest = 6;           // radii of the body per second, along the skin
constexpr double stroke = 0.015;        // heights of the view per stroke of an arrow key
constexpr double longest_step = 0.05;   // s, longest time step; after a longer frame the tool moves
                                        // no farther

/// Returns whether two places are equal. Two places that are not finite are equal too.
bool same(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a == b || (!a.allFinite() && !b.allFinite());
}

}  // namespace

void MouseHand::update(const HapticModel& model, ContactMode contact, const OrbitCamera& camera,
                       const HandInput& input) {
  use(model, contact == ContactMode::glued);
  seen_ = placeUnder(model.surface(), camera, input.pointer);
  double seconds = std::clamp(input.seconds, 0.0, longest_step);
  const bool pressed = input.button && !last_.button;
  if (pressed && seen_ && seen_->touchable) {
    // Take over from the keys: the tool disappears at their place and appears under the pointer.
    if (held_) ++target_.appearance;
    takeHold(*seen_, false);
    seconds = 0;  // at first the tool is outside, in front of the place
  } else if (held_) {
    if (input.out || (by_key_ ? input.take || pressed : !input.button)) {
      held_ = false;
      if (glued_) place_.reset();
    } else {
      follow(camera, input, seconds);
    }
  } else if (input.take) {
    takeHold(place_.value_or(placeInFront(camera)), true);
    seconds = 0;
  } else if (!place_ || depth_ <= -lifted * gap()) {
    hover(camera, input);
  }
  last_ = input;
  moveTool(seconds);
}

void MouseHand::use(const HapticModel& model, bool glued) {
  if (&model == model_ && glued == glued_) return;
  const std::uint32_t appearance = target_.appearance;
  *this = {};
  target_.appearance = appearance;
  model_ = &model;
  glued_ = glued;
  radius_ = sphereAround(model.surface().vertices()).radius;
}

/// Returns the place where a press by key begins if the pointer is over no touchable place.
PointedPlace MouseHand::placeInFront(const OrbitCamera& camera) const {
  const auto middle = placeUnder(model_->surface(), camera, Eigen::Vector2d::Zero());
  if (middle && middle->touchable) return *middle;
  return touchablePlace(model_->surface(), camera.position());
}

void MouseHand::takeHold(const PointedPlace& place, bool by_key) {
  place_ = place;
  held_ = came_in_ = true;
  by_key_ = by_key;
  pulled_.setZero();
  depth_ = glued_ ? 0 : -gap();
  if (glued_) wanted_ = 0;
  if (!wanted_) wanted_ = std::min(usual_depth, usual_share * reach());
}

/// Lets the tool wait in front of the place under the pointer, or of the place that keys move.
void MouseHand::hover(const OrbitCamera& camera, const HandInput& input) {
  if (!input.strokes.isZero()) {
    const PointedPlace from = place_.value_or(placeInFront(camera));
    const Eigen::Vector2d way = stroke * input.strokes;
    place_ = touchablePlace(model_->surface(),
                            from.position + camera.moveInPlane(from.position, way.x(), way.y()));
    by_key_ = true;
  } else if (!same(input.pointer, pointed_)) {  // if the pointer does not move, keep the place
    pointed_ = input.pointer;
    place_ = seen_ && seen_->touchable ? seen_ : std::nullopt;
    by_key_ = false;
  }
  if (place_) depth_ = -gap();
  // At an edge of the body contact may last with the tool outside; reappearing ends the contact.
  if (std::exchange(came_in_, false)) ++target_.appearance;
}

void MouseHand::follow(const OrbitCamera& camera, const HandInput& input, double seconds) {
  const double step = reach() / notches, least = glued_ ? -largest_share * reach() : step;
  wanted_ = std::clamp(*wanted_ + step * input.deeper, least, largest_share * reach());
  Eigen::Vector2d way = stroke * input.strokes;
  if (!by_key_ && input.pointer.allFinite() && last_.pointer.allFinite())
    way = input.pointer - last_.pointer;
  if (glued_)
    pullBy(camera.moveInPlane(place_->position + pulled_, way.x(), way.y()));
  else if (by_key_ && !way.isZero())
    slideTo(place_->position + camera.moveInPlane(place_->position, way.x(), way.y()), seconds);
  else if (!by_key_ && seen_ && seen_->touchable)  // if the pointer is off the body, stay
    slideTo(seen_->position, seconds);
}

void MouseHand::pullBy(const Eigen::Vector3d& way) {
  pulled_ += way;
  const double most = largest_share * reach(), length = pulled_.norm();
  if (length > most) pulled_ *= most / length;
}

void MouseHand::slideTo(const Eigen::Vector3d& goal, double seconds) {
  Eigen::Vector3d way = goal - place_->position;
  const double most = fastest * radius_ * seconds;
  if (way.norm() > most) way *= most / way.norm();
  place_ = touchablePlace(model_->surface(), place_->position + way);
}

void MouseHand::moveTool(double seconds) {
  if (!place_ || (glued_ && !held_)) {
    target_.position = nowhere();
    return;
  }
  const double goal = held_ ? *wanted_ : -gap();
  const double rate = held_ ? press_rate : release_rate;
  depth_ = std::lerp(goal, depth_, std::exp(-rate * seconds));
  const Eigen::Vector3d position = place_->position - depth_ * place_->normal + pulled_;
  // If the straight line to the new position would pass through the skin, the tool disappears and
  // reappears.
  const bool from_nowhere = !target_.position.allFinite();
  const bool outside = depth_ < 0 && !glued_;
  if (from_nowhere ||
      (outside && model_->surface().tree().entry(target_.position, position).triangle >= 0))
    ++target_.appearance;
  target_.position = position;
}

/// Returns the largest workspace radius of the spaces at the place, m.
double MouseHand::reach() const {
  double reach = 0;
  for (const CornerShares& share : model_->surface().cornerSharesOf(place_->triangle))
    reach = std::max(reach, model_->spaces()[at(share.space)].lattice.radius());
  return reach;
}

/// Returns the distance between the skin and the waiting tool, m. It is smaller where another part
/// of the body is close in front of the skin.
double MouseHand::gap() const {
  double gap = waiting_share * radius_;
  const SurfaceTree& tree = model_->surface().tree();
  for (int half = 0; half < 5; ++half, gap /= 2)
    if (tree.nearest(place_->position + gap * place_->normal, place_->triangle).outside) break;
  return gap;
}

}  // namespace palpate
