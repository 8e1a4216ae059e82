#include "viewer/picture/surface_rounding.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

/// An octahedron with the normals of a ball around it.
struct Octahedron {
  Eigen::Matrix3Xf vertices{3, 6};
  std::vector<std::uint32_t> corners = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                        2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  Octahedron() {
    vertices << 1, -1, 0, 0, 0, 0,  //
        0, 0, 1, -1, 0, 0,          //
        0, 0, 0, 0, 1, -1;
  }
};

/// The vertices after `levels` refinements by the normals.
Eigen::Matrix3Xf refined(const Octahedron& solid, int levels) {
  std::vector<std::uint32_t> corners = solid.corners;
  Eigen::Matrix3Xf positions = solid.vertices, normals = solid.vertices;
  for (int level = 0; level < levels; ++level) {
    const SurfaceRounding rounding(corners, static_cast<std::size_t>(positions.cols()));
    positions.conservativeResize(3, static_cast<Eigen::Index>(rounding.vertices()));
    normals.conservativeResize(3, positions.cols());
    rounding.fill(positions, normals);
    corners.assign(rounding.corners().begin(), rounding.corners().end());
  }
  return positions;
}

TEST(SurfaceRounding, LeavesSharpEdgesStraight) {
  const Eigen::Matrix3Xf once = refined({}, 1);
  ASSERT_EQ(once.cols(), 6 + 12);
  for (Eigen::Index v = 6; v < once.cols(); ++v)
    EXPECT_NEAR(once.col(v).norm(), std::sqrt(0.5), 1e-6) << "90 degrees from end to end";
}

TEST(SurfaceRounding, KeepsVerticesAndRoundsBetweenThem) {
  // A part of a sphere of radius 1, 30 degrees wide.
  const float angle = 0.2618F;
  Eigen::Matrix3Xf positions(3, 6), normals(3, 6);
  for (int n = 0; n < 3; ++n) {
    const float turn = 2.0944F * static_cast<float>(n);
    positions.col(n) = Eigen::Vector3f(std::sin(angle) * std::cos(turn),
                                       std::sin(angle) * std::sin(turn), std::cos(angle));
    normals.col(n) = positions.col(n);
  }
  const Eigen::Matrix3Xf before = positions.leftCols(3);
  const SurfaceRounding rounding(std::vector<std::uint32_t>{0, 1, 2}, 3);
  ASSERT_EQ(rounding.vertices(), 6U);
  rounding.fill(positions, normals);
  EXPECT_EQ(positions.leftCols(3), before);
  for (int n = 3; n < 6; ++n) {
    EXPECT_NEAR(positions.col(n).norm(), 1, 2e-3) << "on the ball";
    EXPECT_NEAR(normals.col(n).norm(), 1, 1e-6);
  }
}

TEST(SurfaceRounding, IsClosedWhereTheSurfaceIs) {
  const SurfaceRounding rounding(Octahedron().corners, 6);
  EXPECT_EQ(rounding.corners().size(), 4 * Octahedron().corners.size());
  for (const std::uint32_t corner : rounding.corners()) EXPECT_LT(corner, rounding.vertices());
  std::vector<float> values(rounding.vertices(), 0);
  values[0] = 1;
  rounding.fill(values);
  EXPECT_EQ(std::count(values.begin(), values.end(), 0.5F), 4) << "the edges at the vertex";
}

}  // namespace
}  // namespace palpate
