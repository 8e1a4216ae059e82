#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "common/scene/scene.hpp"
#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/pointed_place.hpp"

namespace palpate {

/// Input for the hand by mouse and keys since the last picture.
struct HandInput {
  /// in heights of the view, (0, 0) at its middle; not finite: not over the view
  Eigen::Vector2d pointer = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool button = false;  ///< the button is held
  double deeper = 0;    ///< notches of the wheel or strokes of a key; < 0: higher
  /// strokes of the arrow keys, to the right and upward on the screen
  Eigen::Vector2d strokes = Eigen::Vector2d::Zero();
  bool take = false;   ///< the key that presses or grips, and releases
  bool out = false;    ///< the key that always releases
  double seconds = 0;  ///< since the last picture
};

/// A hand without a device: turns mouse and keys into the position of the tool.
///
/// The tool waits slightly outside the skin, in front of the place under the pointer. While the
/// button is held, or after the key, it is pressed in along the normal and slides over the surface
/// after the pointer. The wheel changes the depth. The tool then comes out along the way it went
/// in. The button takes over a press by keys on a touchable place, and ends it elsewhere.
///
/// In glued contact there is no tool until it grips the place; then it is pulled in the plane of
/// the screen. The tool never passes through the body from one place to another: it disappears and
/// reappears.
///
/// Places are on the surface at rest. Places on the deformed surface would slip away under a still
/// pointer. One thread.
class MouseHand {
 public:
  /// Handles one picture. contact: mode of the loop. The model may change between calls.
  void update(const HapticModel& model, ContactMode contact, const OrbitCamera& camera,
              const HandInput& input);

  /// Returns the target position of the tool.
  const MouseTarget& target() const { return target_; }
  /// Returns whether the tool presses or grips; button and wheel then belong to the hand, not the
  /// camera.
  bool holds() const { return held_; }
  /// Returns whether the key holds the tool, so there is no button to release.
  bool holdsByKey() const { return held_ && by_key_; }
  /// Returns the place under the pointer, touchable or not.
  const std::optional<PointedPlace>& seen() const { return seen_; }
  /// Returns the place that the tool waits in front of, or presses.
  const std::optional<PointedPlace>& place() const { return place_; }
  /// Returns whether keys chose place(), not the pointer.
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
  double radius_ = 0;  ///< radius of the body, m
  std::optional<PointedPlace> seen_, place_;
  bool held_ = false;
  bool by_key_ = false;   ///< keys made the last press or moved the place
  bool came_in_ = false;  ///< since the tool was last free
  HandInput last_;
  Eigen::Vector2d pointed_ = HandInput().pointer;  ///< pointer when it chose the place
  std::optional<double> wanted_;                   ///< m, along the inward normal, while held
  double depth_ = 0;                               ///< current depth, m; < 0: outside
  /// offset from the place, m; glued only
  Eigen::Vector3d pulled_ = Eigen::Vector3d::Zero();
  MouseTarget target_;
};

}  // namespace palpate
