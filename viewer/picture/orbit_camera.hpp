#pragma once

#include <Eigen/Geometry>

namespace palpate {

/// A perspective camera that goes around a point. Metres, scene frame; angles in radians; places on
/// the screen in heights of the picture, (0, 0) its middle, x to the right, y upward.
class OrbitCamera {
 public:
  /// radians that the picture shows from bottom to top
  static constexpr double height_angle = 0.6;

  /// Looks at a sphere, from where `from` (any length but 0) points to, so that it fits. aspect:
  /// width over height. `up` is the direction that stays upward; not parallel to `from`.
  void frame(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& from,
             const Eigen::Vector3d& up, double aspect);
  /// The same sphere from the same side.
  void frame(const Eigen::Vector3d& centre, double radius, double aspect);

  /// Turns around the centre; angles: to the right, and upward. It stops short of the poles.
  void orbit(double right, double upward);
  /// The scene follows a hand that moves by so much on the screen.
  void pan(double right, double upward);
  /// Distance times factor; within what the sphere allows.
  void zoom(double factor);

  Eigen::Vector3d position() const { return centre_ + distance_ * back(); }
  /// Columns: right, up, back (toward the viewer).
  Eigen::Matrix3d axes() const;
  double distance() const { return distance_; }  ///< from position() to the centre of turning
  double near() const;                           ///< m, clipping planes around the framed sphere
  double far() const;

  /// Where a point is seen, and in `z` its distance from the plane of the camera (> 0: in front of
  /// it).
  Eigen::Vector3d project(const Eigen::Vector3d& point) const;
  /// The direction, unit, in which from position() all is that is seen at a place on the screen.
  Eigen::Vector3d ray(const Eigen::Vector2d& place) const;
  /// How far in the scene a move on the screen is, in the plane parallel to it through `at`.
  Eigen::Vector3d moveInPlane(const Eigen::Vector3d& at, double right, double upward) const;

 private:
  Eigen::Vector3d back() const;

  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero(), framed_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitY();
  Eigen::Vector3d east_ = Eigen::Vector3d::UnitX();  ///< where azimuth is 0; right angles to up_
  double azimuth_ = 0, elevation_ = 0;
  double distance_ = 1, radius_ = 0.3;
};

}  // namespace palpate
