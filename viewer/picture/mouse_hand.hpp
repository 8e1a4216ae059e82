#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "common/scene/scene.hpp"
#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/pointed_place.hpp"

namespace palpate {

/// What a person does with the hand, by mouse and keys, since the last picture.
struct HandInput {
  /// heights of the view, (0, 0) its middle; not finite: not over the view
  Eigen::Vector2d pointer = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool button = false;  ///< is held
  double deeper = 0;    ///< notches of the wheel, strokes of a key; < 0: higher
  /// strokes of the arrow keys, to the right and upward on the screen
  Eigen::Vector2d strokes = Eigen::Vector2d::Zero();
  bool take = false;   ///< the key that takes hold, and lets go
  bool out = false;    ///< the key that lets go, whatever holds
  double seconds = 0;  ///< since the last picture
};

/// A hand without a device: mouse and keys become the place of the tool.
///
/// The tool waits before the place that is pointed at, a little outside of the skin. While the
/// button is held, or the key took hold, it is pressed in along the normal, to a depth that the
/// wheel changes, and slides over the surface after the pointer; then it comes out the way it went
/// in. The button takes a press by keys over where it can touch, and ends it elsewhere. Where
/// contact is glued there is no tool until it takes hold in the place; it is pulled in the plane of
/// the screen then. The tool never goes through the body from one place to another: it vanishes
/// here and appears there.
///
/// Places are of the surface at rest: what is seen of the deformed one would slip away under a
/// pointer that stands still. One thread.
class MouseHand {
 public:
  /// One picture. contact: of the loop. The model may be another than the last.
  void update(const HapticModel& model, ContactMode contact, const OrbitCamera& camera,
              const HandInput& input);

  /// Where the tool is to be.
  const MouseTarget& target() const { return target_; }
  /// Something is held: button and wheel are the hand's, not the camera's.
  bool holds() const { return held_; }
  /// The key took hold: no button is held that could be let go.
  bool holdsByKey() const { return held_ && by_key_; }
  /// What is pointed at, whether it can be touched or not.
  const std::optional<PointedPlace>& seen() const { return seen_; }
  /// What the tool waits before, or presses.
  const std::optional<PointedPlace>& place() const { return place_; }
  /// Keys chose place(), if there is one, and not the pointer.
  bool placedByKeys() const { return by_key_; }

 private:
  void use(const HapticModel& model, bool glued);
  PointedPlace placeInFront(const OrbitCamera& camera) const;
  void takeHold(const PointedPlace& place, bool by_key);
  void letGo();
  void hover(const OrbitCamera& camera, const HandInput& input);
  void follow(const OrbitCamera& camera, const HandInput& input, double seconds);
  void pullBy(const Eigen::Vector3d& way);
  void slideTo(const Eigen::Vector3d& goal, double seconds);
  void goTo(const Eigen::Vector3d& position);
  void moveTool(double seconds);
  double reach() const;
  double gap() const;

  const HapticModel* model_ = nullptr;
  bool glued_ = false;
  double radius_ = 0;  ///< m, of the body
  std::optional<PointedPlace> seen_, place_;
  bool held_ = false;
  bool by_key_ = false;   ///< keys took hold last, or moved the place
  bool came_in_ = false;  ///< since the tool was free last
  HandInput last_;
  Eigen::Vector2d pointed_ = HandInput().pointer;  ///< where it was when it chose the place
  std::optional<double> wanted_;                   ///< m, along the inward normal, while held
  double depth_ = 0;                               ///< m, now; < 0: outside
  /// m, from the place; glued
  Eigen::Vector3d pulled_ = Eigen::Vector3d::Zero();
  MouseTarget target_;
};

}  // namespace palpate
