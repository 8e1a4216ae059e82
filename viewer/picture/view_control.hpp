#pragma once

#include <Eigen/Core>
#include <optional>

#include "viewer/picture/orbit_camera.hpp"

namespace palpate {

/// What the mouse did since the last picture; lengths in heights of the view, y upward.
struct MouseMotion {
  double right = 0, upward = 0;
  double wheel = 0;                  ///< notches, > 0: away from the person
  bool over_view = false;            ///< not over a panel
  bool left = false, other = false;  ///< buttons that are held: left; right or middle
  bool shift = false, control = false;
};

/// The sphere that F shows.
struct FramedSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m
  double radius = 0.1;                               ///< m
};

/// Turns mouse motion into camera moves or, with Ctrl held, into moves of the tool: in the plane
/// through it parallel to the screen, by the wheel in depth. The tool moves by as much as the mouse
/// does, from where it is when Ctrl goes down: it never jumps to the mouse. One thread.
class ViewControl {
 public:
  /// tool: where the tool is now. Where the mouse wants it, while Ctrl is held.
  std::optional<Eigen::Vector3d> apply(const MouseMotion& motion, const Eigen::Vector3d& tool,
                                       const FramedSphere& scene, OrbitCamera& camera);

 private:
  void moveCamera(const MouseMotion& motion, OrbitCamera& camera);
  void moveTool(const MouseMotion& motion, const FramedSphere& scene, const OrbitCamera& camera);

  bool dragging_ = false;  ///< a drag that began in the view goes on beyond it
  std::optional<Eigen::Vector3d> target_;
};

}  // namespace palpate
