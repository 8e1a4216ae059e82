#pragma once

#include <Eigen/Geometry>

namespace palpate {

/// A perspective camera that orbits a point. Metres, scene frame; angles in radians. Screen
/// positions are in heights of the picture, (0, 0) at its middle, x to the right, y upward.
class OrbitCamera {
 public:
  /// vertical angle of view, radians
  static constexpr double height_angle = 0.6;

  /// Looks at a sphere so that it fits.
  ///
  /// from: direction from the sphere to the camera, of any length but 0. up: direction that stays
  /// upward, not parallel to `from`. aspect: width / height.
  void frame(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& from,
             const Eigen::Vector3d& up, double aspect);
  /// Frames a sphere from the current side.
  void frame(const Eigen::Vector3d& centre, double radius, double aspect);

  /// Turns around the centre by angles to the right and upward. Stops short of the poles.
  void orbit(double right, double upward);
  /// Moves the scene with the pointer, by a distance on the screen.
  void pan(double right, double upward);
  /// Multiplies the distance by a factor, within the limits that the sphere sets.
  void zoom(double factor);

  Eigen::Vector3d position() const { return centre_ + distance_ * back(); }
  /// Returns the axes in columns: right, up, back (toward the viewer).
  Eigen::Matrix3d axes() const;
  double distance() const { return distance_; }  ///< from position() to the centre of rotation
  double near() const;                           ///< m, clipping planes around the framed sphere
  double far() const;

  /// Returns the screen position of a point, and in `z` its distance from the plane of the camera
  /// (> 0: in front of it).
  Eigen::Vector3d project(const Eigen::Vector3d& point) const;
  /// Returns the unit direction from position() through a place on the screen.
  Eigen::Vector3d ray(const Eigen::Vector2d& place) const;
  /// Returns the distance in the scene of a move on the screen, in the plane through `at` parallel
  /// to the screen.
  Eigen::Vector3d moveInPlane(const Eigen::Vector3d& at, double right, double upward) const;

 private:
  Eigen::Vector3d back() const;

  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero(), framed_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitY();
  Eigen::Vector3d east_ = Eigen::Vector3d::UnitX();  ///< azimuth 0; perpendicular to up_
  double azimuth_ = 0, elevation_ = 0;
  double distance_ = 1, radius_ = 0.3;
};

}  // namespace palpate
