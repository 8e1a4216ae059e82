#pragma once

#include "viewer/organ/carried_organ.hpp"

namespace palpate::test {

/// A space with a stiffness of 60 N/m in a ball of `radius` metres, and with a small
/// configurational force if there is a finger.
inline SpaceTable springs(const std::optional<Finger>& finger, double radius = 0.02) {
  SpaceTable space;
  space.patch.finger = finger;
  space.lattice = Lattice(radius, 0.02, 2, finger ? finger->reach : PushedPart{});
  space.points.resize(static_cast<std::size_t>(space.lattice.size()));
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    PointRecord& point = space.points[static_cast<std::size_t>(n)];
    point.tag = Tag::expandable;
    const Eigen::Vector3d p = space.lattice.displacement(n);
    Equilibrium& e = point.equilibrium;
    e.energy = 30 * p.squaredNorm();
    e.force = -60 * p;
    e.stiffness = -60 * Eigen::Matrix3d::Identity();
    if (finger) e.drive = {0.5 * e.energy, 0, 0};
  }
  return space;
}

/// The smallest organ that has all parts: a tetrahedron of 100 mm. It is touched at an active node
/// at its tip or, with `finger`, to the depth `deep` at two sites of a finger of radius 30 mm.
inline CarriedOrgan smallOrgan(bool finger, double deep = 0.02, const PushedPart& reach = {}) {
  constexpr double radius = 0.03;
  CarriedOrgan organ;
  organ.name = "small";
  organ.max_force = 8;
  organ.vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  organ.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  organ.touch_of_triangle = {-1, 0, 0, 0};
  CarriedTouch& touch = organ.touches.emplace_back();
  touch.name = "all";
  if (finger) {
    touch.finger_radius = radius;
    touch.collocation_points = {{0.02, 0, 0.02}, {0.03, 0.03, 0.03}};
    for (const Eigen::Vector3d& collocation_point : touch.collocation_points)
      organ.spaces.push_back(springs(Finger{collocation_point, radius, reach}, deep));
    touch.spaces = {0, 1};
  } else {
    touch.rest = organ.vertices[3];
    organ.spaces = {springs(std::nullopt)};
    touch.spaces = {0};
  }
  organ.shapes.mode_count = 3;
  for (std::size_t i = 0; i < 3 * 3 * organ.vertices.size(); ++i)
    organ.shapes.modes.push_back(i % 3 == i / (3 * organ.vertices.size()) ? 0.5f : 0);
  for (const SpaceTable& space : organ.spaces)
    for (auto& shares = organ.shapes.shares.emplace_back(); const PointRecord& point : space.points)
      for (const double x : point.equilibrium.force) shares.push_back(static_cast<float>(-x / 30));
  return organ;
}

}  // namespace palpate::test
