#include "viewer/picture/turned_solid.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "common/base/assertion.hpp"
#include "viewer/picture/open_gl.hpp"

namespace palpate {
namespace {

constexpr int few = 12, some = 16, many = 28;  // numbers of corners of a circle

/// Returns the outward normal of the segment between two points of a profile.
Eigen::Vector2d normalOf(const ProfilePoint& from, const ProfilePoint& to) {
  const Eigen::Vector2d normal(to.height - from.height, from.radius - to.radius);
  const double length = normal.norm();
  return length > 0 ? Eigen::Vector2d(normal / length) : Eigen::Vector2d::Zero();
}

void addArc(std::vector<ProfilePoint>& profile, double radius, double middle, double from,
            double to, int steps) {
  for (int n = 0; n <= steps; ++n) {
    const double angle = std::lerp(from, to, static_cast<double>(n) / steps);
    profile.push_back({radius * std::cos(angle), middle + radius * std::sin(angle)});
  }
}

}  // namespace

TurnedSolid::TurnedSolid(std::span<const ProfilePoint> profile, int around) {
  PALPATE_ASSERT(profile.size() >= 2, "the profile of a solid needs two points");
  const auto ring = static_cast<std::uint32_t>(around + 1);
  for (std::size_t n = 0; n < profile.size(); ++n) {
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    if (n > 0) slope += normalOf(profile[n - 1], profile[n]);
    if (n + 1 < profile.size()) slope += normalOf(profile[n], profile[n + 1]);
    slope.normalize();
    for (int a = 0; a <= around; ++a) {
      const double angle = 2 * std::numbers::pi * a / around;
      const Eigen::Vector2d out(std::cos(angle), std::sin(angle));
      const Eigen::Vector2d place = profile[n].radius * out, normal = slope.x() * out;
      for (const double x : {place.x(), place.y(), profile[n].height})
        positions_.push_back(static_cast<float>(x));
      for (const double x : {normal.x(), normal.y(), slope.y()})
        normals_.push_back(static_cast<float>(x));
      if (n == 0 || a == around) continue;
      const std::uint32_t here =
                              static_cast<std::uint32_t>(n) * ring + static_cast<std::uint32_t>(a),
                          below = here - ring;
      corners_.insert(corners_.end(), {below, below + 1, here, here, below + 1, here + 1});
    }
  }
}

TurnedSolid TurnedSolid::ball() {
  std::vector<ProfilePoint> profile;
  addArc(profile, 1, 0, -std::numbers::pi / 2, std::numbers::pi / 2, 8);
  return TurnedSolid(profile, some);
}

TurnedSolid TurnedSolid::cylinder(int around) {
  return {std::vector<ProfilePoint>{{0, 0}, {1, 0}, {1, 0}, {1, 1}, {1, 1}, {0, 1}}, around};
}

TurnedSolid TurnedSolid::cone() {
  return {std::vector<ProfilePoint>{{0, 0}, {1, 0}, {1, 0}, {0, 1}}, some};
}

TurnedSolid TurnedSolid::handle() {
  return {std::vector<ProfilePoint>{{1, 0}, {1, 0.96}, {0.7, 0.99}, {0, 1}}, few};
}

TurnedSolid TurnedSolid::finger() {
  constexpr double slim = 0.84, end = 2.7;
  std::vector<ProfilePoint> profile;
  addArc(profile, 1, 0, -std::numbers::pi / 2, 0, 8);
  profile.push_back({std::lerp(1, slim, 0.9 / end), 0.9});
  for (const double angle : {0.0, 0.4, 0.8, 1.2, std::numbers::pi / 2})
    profile.push_back({slim * std::cos(angle), end + 0.5 * slim * std::sin(angle)});
  return {profile, many};
}

void TurnedSolid::draw(const Eigen::Vector3d& place, const Eigen::Vector3d& axis, double wide,
                       double length) const {
  const Eigen::Vector3d x = axis.unitOrthogonal();
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.col(0).head<3>() = wide * x;
  matrix.col(1).head<3>() = wide * axis.cross(x);
  matrix.col(2).head<3>() = length * axis;
  matrix.col(3).head<3>() = place;
  glMatrixMode(GL_MODELVIEW);
  glPushMatrix();
  glMultMatrixd(matrix.data());
  glEnableClientState(GL_VERTEX_ARRAY);
  glEnableClientState(GL_NORMAL_ARRAY);
  glVertexPointer(3, GL_FLOAT, 0, positions_.data());
  glNormalPointer(GL_FLOAT, 0, normals_.data());
  glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(corners_.size()), GL_UNSIGNED_INT,
                 corners_.data());
  glPopMatrix();
}

}  // namespace palpate
