#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace palpate {

/// The sphere that the F key brings into view.
struct FramedSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< m
  double radius = 0.1;                               ///< m
};

/// Returns a sphere around all vertices (m), nearly the smallest. Its centre is that of their
/// bounding box.
inline FramedSphere sphereAround(const std::vector<Eigen::Vector3d>& vertices) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : vertices) box.extend(vertex);
  FramedSphere sphere{box.center(), 0};
  for (const Eigen::Vector3d& vertex : vertices)
    sphere.radius = std::max(sphere.radius, (vertex - sphere.centre).norm());
  return sphere;
}

/// Returns whether a camera that frames one sphere shows the other equally well, because both have
/// nearly the same place and size.
inline bool isFramedWith(const FramedSphere& one, const FramedSphere& other) {
  const double larger = std::max(one.radius, other.radius);
  return 2 * std::min(one.radius, other.radius) > larger &&
         2 * (one.centre - other.centre).norm() < larger;
}

}  // namespace palpate
