#include "viewer/picture/orbit_camera.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

constexpr double steepest = 0.49 * std::numbers::pi;
constexpr double air = 1.08;  ///< factor on the radius of the framed sphere, for a margin around it

}  // namespace

void OrbitCamera::frame(const Eigen::Vector3d& centre, double radius, const Eigen::Vector3d& from,
                        const Eigen::Vector3d& up, double aspect) {
  up_ = up.normalized();
  const Eigen::Vector3d across = from - from.dot(up_) * up_;
  east_ = across.norm() > 1e-9 * from.norm() ? across.normalized() : up_.unitOrthogonal();
  azimuth_ = 0;
  elevation_ = std::clamp(std::atan2(from.dot(up_), across.norm()), -steepest, steepest);
  frame(centre, radius, aspect);
}

void OrbitCamera::frame(const Eigen::Vector3d& centre, double radius, double aspect) {
  PALPATE_ASSERT(radius > 0 && aspect > 0, "a body and its view must not be empty");
  centre_ = framed_ = centre;
  radius_ = radius;
  // In a narrow picture the width decides the distance.
  const double half = std::min(height_angle / 2, std::atan(std::tan(height_angle / 2) * aspect));
  distance_ = air * radius / std::sin(half);
}

void OrbitCamera::orbit(double right, double upward) {
  azimuth_ += right;
  elevation_ = std::clamp(elevation_ + upward, -steepest, steepest);
}

void OrbitCamera::pan(double right, double upward) {
  centre_ -= moveInPlane(centre_, right, upward);
}

void OrbitCamera::zoom(double factor) {
  distance_ = std::clamp(distance_ * factor, 0.05 * radius_, 20 * radius_);
}

Eigen::Vector3d OrbitCamera::back() const {
  const Eigen::Vector3d north = up_.cross(east_);
  return std::cos(elevation_) * (std::cos(azimuth_) * east_ + std::sin(azimuth_) * north) +
         std::sin(elevation_) * up_;
}

Eigen::Matrix3d OrbitCamera::axes() const {
  Eigen::Matrix3d axes;
  axes.col(2) = back();
  axes.col(0) = up_.cross(axes.col(2)).normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return axes;
}

double OrbitCamera::near() const {
  const double depth = (position() - framed_).dot(back());
  return std::max(depth - 3 * radius_, 0.02 * radius_);
}

double OrbitCamera::far() const {
  const double depth = (position() - framed_).dot(back());
  return std::max(depth, 0.0) + 3 * radius_;
}

Eigen::Vector3d OrbitCamera::project(const Eigen::Vector3d& point) const {
  const Eigen::Vector3d local = axes().transpose() * (point - position());
  const double depth = -local.z();
  const double scale = 0.5 / (std::tan(height_angle / 2) * depth);
  return {local.x() * scale, local.y() * scale, depth};
}

Eigen::Vector3d OrbitCamera::ray(const Eigen::Vector2d& place) const {
  const double scale = 2 * std::tan(height_angle / 2);
  return (axes() * Eigen::Vector3d(scale * place.x(), scale * place.y(), -1)).normalized();
}

Eigen::Vector3d OrbitCamera::moveInPlane(const Eigen::Vector3d& at, double right,
                                         double upward) const {
  const double depth = std::max((position() - at).dot(back()), near());
  const double metres = 2 * std::tan(height_angle / 2) * depth;  // per height of the picture
  const Eigen::Matrix3d frame = axes();
  return metres * (right * frame.col(0) + upward * frame.col(1));
}

}  // namespace palpate
