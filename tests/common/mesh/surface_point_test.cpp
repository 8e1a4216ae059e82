#include "common/mesh/surface_point.hpp"

#include <gtest/gtest.h>

#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

TEST(SurfacePointTest, IsTheNearestOfAllTriangles) {
  const Mesh mesh = test::cubeMesh(0.2, 3);
  for (const Eigen::Vector3d& near :
       {Eigen::Vector3d(0.11, 0.07, 0.5), Eigen::Vector3d(0.3, 0.3, 0.3),
        Eigen::Vector3d(0.1, 0.19, 0.1)}) {
    const SurfacePoint point = nearestOnSurface(mesh, near);
    Eigen::Vector3d expected = near.cwiseMin(0.2).cwiseMax(0.0);
    if (expected == near) expected[1] = 0.2;  // inside: the nearest side
    EXPECT_LT((positionOf(mesh, point) - expected).norm(), 1e-14) << near.transpose();
    EXPECT_NEAR(point.barycentric.sum(), 1, 1e-14);
  }
}

TEST(SurfacePointTest, IsFoundForPlacesWhoseSquaredDistanceOverflows) {
  const Mesh mesh = test::cubeMesh(0.2, 3);
  for (const double far : {1e10, 1e200, 1.7e308}) {
    const SurfacePoint point = nearestOnSurface(mesh, {far, far, -far});
    ASSERT_GE(point.triangle, 0) << far;
    EXPECT_LT((positionOf(mesh, point) - Eigen::Vector3d(0.2, 0.2, 0)).norm(), 1e-6) << far;
  }
}

TEST(SurfacePointTest, NormalsPointOutward) {
  const Mesh mesh = test::cubeMesh(0.2, 3);
  const SurfacePoint top = nearestOnSurface(mesh, {0.1, 0.08, 0.3});
  EXPECT_LT((normalOf(mesh, top.triangle) - Eigen::Vector3d::UnitZ()).norm(), 1e-14);
}

}  // namespace
}  // namespace palpate
