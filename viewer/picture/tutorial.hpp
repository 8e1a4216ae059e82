#pragma once

#include <Eigen/Core>
#include <string>

#include "viewer/haptics/haptic_model.hpp"
#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// What the hand of the tutorial does with its mouse, at one time.
struct TutorialGesture {
  Eigen::Vector2d pointer = Eigen::Vector2d::Zero();  ///< heights of the view, (0, 0) its middle
  bool button = false;                                ///< is held
  double wheel = 0;                                   ///< notches since the last picture
  const char* caption = "";                           ///< a sentence
};

/// Ten seconds in which a mouse that is drawn shows what a mouse can do: it points, presses,
/// slides, presses deeper, lets go, and turns the body. It moves the same hand that a person's
/// mouse moves. Knows no graphics. One thread.
class Tutorial {
 public:
  static constexpr double duration = 10;  ///< s

  /// Plays on for some seconds; what the mouse does then. model and camera: of the picture.
  TutorialGesture advance(const HapticModel& model, const OrbitCamera& camera, double seconds);
  bool over() const { return time_ >= duration; }

 private:
  void choosePlaces(const HapticModel& model, const OrbitCamera& camera);

  double time_ = 0;  ///< s
  bool chosen_ = false;
  Eigen::Vector2d beside_ = {0, 0}, first_ = {0, 0}, second_ = {0, 0};  ///< as the pointer
};

}  // namespace palpate
