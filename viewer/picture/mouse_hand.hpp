#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>

#include "common/scene/scene.hpp"
#include "viewer/haptics/haptic_device.hpp"
#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/pointed_place.hpp"

namespace palpate {

/// Input for the hand by mouse and keys since the last frame.
struct HandInput {
  /// in heights of the view, (0, 0) at its middle; not finite while the pointer is not over the
  /// view
  Eigen::Vector2d pointer = Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN());
  bool button = false;  ///< the mouse button is held down
  double deeper = 0;    ///< notches of the wheel or strokes of a key; negative: less deep
  /// Strokes of the arrow keys, to the right and upward on the screen.
  Eigen::Vector2d strokes = Eigen::Vector2d::Zero();
  bool take = false;   ///< the key that presses or grips, or releases a held tool, was pressed
  bool out = false;    ///< the key that only releases was pressed
  double seconds = 0;  ///< time since the last frame, s
};

/// A hand without a device: turns mouse and keys into a position of the tool.
///
/// Unilateral contact: the tool waits slightly outside the skin, in front of the place under the
/// pointer. While the mouse button is held, or after the key was pressed, the tool is pressed in
/// along the normal and slides over the surface after the pointer. The wheel changes the depth.
/// When released, the tool comes out in the direction in which it went in. If the mouse button is
/// pressed while keys hold the tool pressed, the press moves to the place under the pointer if that
/// is touchable, and otherwise ends.
///
/// Glued contact: the tool appears when it grips the place, and is then pulled in the plane of the
/// screen.
///
/// The tool never passes through the body from one place to another: it disappears and reappears.
/// Places are on the surface at rest, because a place on the deformed surface would slip away under
/// a pointer that does not move. One thread.
class MouseHand {
 public:
  /// Handles the input of one frame. contact: contact mode of the loop. The model may change
  /// between calls.
  void update(const HapticModel& model, ContactMode contact, const OrbitCamera& camera,
              const HandInput& input);

  /// Returns the target position of the tool.
  const MouseTarget& target() const { return target_; }
  /// Returns whether the tool presses or grips. Button and wheel then belong to the hand, not to
  /// the camera.
  bool holds() const { return held_; }
  /// Returns whether a key holds the tool, so that there is no button to release.
  bool holdsByKey() const { return held_ && by_key_; }
  /// Returns the place under the pointer, which may be touchable or not.
  const std::optional<PointedPlace>& seen() const { return seen_; }
  /// Returns the place in front of which the tool waits, or at which it presses.
  const std::optional<PointedPlace>& place() const { return place_; }
  /// Returns whether place() was chosen by keys, not by the pointer.
  bool placedByKeys() const { return by_key_; }

 private:
  void use(const HapticModel& model, bool glued);
  PointedPlace placeInFront(const OrbitCamera& camera) const;
  void takeHold(const PointedPlace& place, bool by_key);
  void hover(const OrbitCamera& camera, const HandInput& input);
  void follow(const OrbitCamera& camera, const HandInput& input, double seconds);
  void pullBy(const Eigen::Vector3d& way);
  void slideTo(const Eigen::Vector3d& goal, double seconds);
  void moveTool(double seconds);
  double reach() const;
  double gap() const;

  const HapticModel* model_ = nullptr;
  bool glued_ = false;
  double radius_ = 0;  ///< radius of the body, m
  std::optional<PointedPlace> seen_, place_;
  bool held_ = false;
  bool by_key_ = false;   ///< keys began the last press or moved the place
  bool came_in_ = false;  ///< the tool has pressed since it was last free
  HandInput last_;
  Eigen::Vector2d pointed_ = HandInput().pointer;  ///< position of the pointer when it chose the
                                                   ///< place
  std::optional<double> wanted_;  ///< depth to reach, m, along the inward normal; kept after a
                                  ///< release; empty before the first press
  double depth_ = 0;              ///< current depth, m; negative outside the body
  /// displacement of the tool from the place, m; glued only
  Eigen::Vector3d pulled_ = Eigen::Vector3d::Zero();
  MouseTarget target_;
};

}  // namespace palpate
