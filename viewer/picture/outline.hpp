#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace palpate {

/// A point of an outline. share: 0 to 1, how much of it is drawn there.
struct OutlinePoint {
  Eigen::Vector3f place = Eigen::Vector3f::Zero();  ///< m
  float share = 1;
};

/// Where a smooth surface turns away from an eye: pairs of points, the lines between them. In each
/// triangle the angle between normal and line of sight is interpolated, so lines of neighbours
/// meet, and none follows the edges of triangles to and fro. positions, normals: a column per
/// vertex. corners: three vertices per triangle. shares: one per vertex, interpolated; lines that
/// have none are left out. Fills `out`, which keeps its memory.
void findOutline(const Eigen::Matrix3Xf& positions, const Eigen::Matrix3Xf& normals,
                 std::span<const std::uint32_t> corners, std::span<const float> shares,
                 const Eigen::Vector3f& eye, std::vector<OutlinePoint>& out);

}  // namespace palpate
