#pragma once

#include <Eigen/Geometry>

namespace palpate {

/// A perspective camera that orbits a point. Metres, scene frame; angles in radians. Screen
/// positions are in heights of the picture, with (0, 0) at its middle, x to the right and y upward.
class OrbitCamera {
 public:
  /// vertical angle of view, radians
  static constexpr double height_angle = 0.6;

  /// Looks at a sphere from a distance at which it fits into the picture.
  ///
  /// from: direction from the sphere to the camera, of any length but 0. up: direction that stays
  /// upward, not parallel to `from`. aspect: width / height.
  void frame(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& from,
             const Eigen::Vector3d& up, double aspect);
  /// Frames a sphere from the direction in which the camera is now.
  void frame(const Eigen::Vector3d& centre, double radius, double aspect);

  /// Turns the camera around the centre, by angles to the right and upward. The camera stops before
  /// it reaches a pole.
  void orbit(double right, double upward);
  /// Moves the scene by a distance on the screen, so that it follows the pointer.
  void pan(double right, double upward);
  /// Multiplies the distance by a factor. The framed sphere sets limits for the distance.
  void zoom(double factor);

  Eigen::Vector3d position() const { return centre_ + distance_ * back(); }
  /// Returns the camera's axes as columns: right, up, and back (toward the viewer).
  Eigen::Matrix3d axes() const;
  double distance() const { return distance_; }  ///< m, from position() to the centre of rotation
  /// Return the distances of the clipping planes before and behind the framed sphere, m.
  double near() const;
  double far() const;

  /// Returns the screen position of a point in x and y. z is its distance from the plane of the
  /// camera, positive in front of it.
  Eigen::Vector3d project(const Eigen::Vector3d& point) const;
  /// Returns the unit direction from position() through a place on the screen.
  Eigen::Vector3d ray(const Eigen::Vector2d& place) const;
  /// Returns the displacement in the scene that moves a point by a distance on the screen. The
  /// displacement is parallel to the screen, in the plane through `at`.
  Eigen::Vector3d moveInPlane(const Eigen::Vector3d& at, double right, double upward) const;

 private:
  Eigen::Vector3d back() const;

  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero(), framed_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitY();
  Eigen::Vector3d east_ = Eigen::Vector3d::UnitX();  ///< direction of azimuth 0, perpendicular to
                                                     ///< up_
  double azimuth_ = 0, elevation_ = 0;
  double distance_ = 1, radius_ = 0.3;
};

}  // namespace palpate
