#include "viewer/haptics/touch_surface.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/expect_error.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/touchable_body.hpp"

namespace palpate {
namespace {

class TouchSurfaceTest : public testing::Test {
 protected:
  Dataset sealed(const test::TouchableBody& body) {
    body.seal(directory.path() / "body.h5");
    return Dataset(directory.path() / "body.h5");
  }
  /// The node at a position on a cube of edge 0.1.
  static std::int32_t nodeAt(const Mesh& mesh, const Eigen::Vector3d& x) {
    const auto place = std::ranges::min_element(
        mesh.nodes, {}, [&x](const Eigen::Vector3d& node) { return (node - x).squaredNorm(); });
    return static_cast<std::int32_t>(place - mesh.nodes.begin());
  }
  static double share(const SpaceBlend& blend, std::int32_t space) {
    for (std::int32_t n = 0; n < blend.size; ++n)
      if (blend.shares[static_cast<std::size_t>(n)].space == space)
        return blend.shares[static_cast<std::size_t>(n)].weight;
    return 0;
  }

  test::TemporaryDirectory directory;
  Mesh cube = test::cubeMesh(0.1, 4);
};

TEST_F(TouchSurfaceTest, TheRingAroundAnActiveNodeIsTouchable) {
  const TouchSurface surface(sealed({cube, {{nodeAt(cube, {0.05, 0.05, 0.1})}}}));
  for (std::size_t n = 0; n < surface.triangles().size(); ++n) {
    const auto& corners = surface.triangles()[n];
    const bool has_active = std::ranges::any_of(corners, [&](std::int32_t v) {
      return (surface.vertices()[static_cast<std::size_t>(v)] - Eigen::Vector3d(0.05, 0.05, 0.1))
                 .norm() < 1e-9;
    });
    if (has_active) {
      EXPECT_TRUE(surface.touchable(static_cast<std::int32_t>(n)));
    }
    if (!surface.touchable(static_cast<std::int32_t>(n))) continue;
    for (const std::int32_t v : corners)
      EXPECT_NEAR(surface.vertices()[static_cast<std::size_t>(v)].z(), 0.1, 1e-12);
  }
}

TEST_F(TouchSurfaceTest, KnowsTheVerticesOfItsActiveNodes) {
  const Eigen::Vector3d first(0.05, 0.05, 0.1), second(0.1, 0.025, 0.05);
  const TouchSurface surface(sealed({cube, {{nodeAt(cube, first)}, {nodeAt(cube, second)}}}));
  EXPECT_LT((surface.vertices()[static_cast<std::size_t>(surface.activeVertex(0))] - first).norm(),
            1e-12);
  EXPECT_LT((surface.vertices()[static_cast<std::size_t>(surface.activeVertex(1))] - second).norm(),
            1e-12);
}

TEST_F(TouchSurfaceTest, ReachesAlongTheSurface) {
  const TouchSurface surface(sealed({cube, {{nodeAt(cube, {0.05, 0.05, 0.1})}}}), 0.051);
  for (std::size_t v = 0; v < surface.vertices().size(); ++v) {
    const Eigen::Vector3d& x = surface.vertices()[v];
    const bool reached = !surface.sharesOf(static_cast<std::int32_t>(v)).empty();
    if ((x - Eigen::Vector3d(0.05, 0.05, 0.1)).norm() > 0.051) {
      EXPECT_FALSE(reached) << x.transpose();
    }
    if ((x - Eigen::Vector3d(0.1, 0.05, 0.1)).norm() < 1e-9) {
      EXPECT_TRUE(reached);
    }
    if ((x - Eigen::Vector3d(0.05, 0.05, 0)).norm() < 1e-9) {  // only reachable through the body
      EXPECT_FALSE(reached);
    }
  }
}

TEST_F(TouchSurfaceTest, WeighsTheNearestActiveNodesByDistance) {
  const std::int32_t left = nodeAt(cube, {0, 0.05, 0.1}), right = nodeAt(cube, {0.1, 0.05, 0.1});
  const TouchSurface surface(sealed({cube, {{left}, {right}}}), 0.09);
  for (std::size_t v = 0; v < surface.vertices().size(); ++v) {
    const Eigen::Vector3d& x = surface.vertices()[v];
    const auto shares = surface.sharesOf(static_cast<std::int32_t>(v));
    const auto is = [&x](double px) { return (x - Eigen::Vector3d(px, 0.05, 0.1)).norm() < 1e-9; };
    if (is(0)) {
      ASSERT_EQ(shares.size(), 1u);
      EXPECT_EQ(shares[0].weight, 1);
    }
    if (is(0.05)) {
      EXPECT_NEAR(shares[0].weight, 0.5, 1e-12);
    }
    if (is(0.025)) {
      ASSERT_EQ(shares.size(), 2u);
      const double near = std::pow(1 - 0.025 / 0.09, 2) / 0.025,
                   far = std::pow(1 - 0.075 / 0.09, 2) / 0.075;
      EXPECT_NEAR(shares[0].weight, near / (near + far), 1e-9);
    }
  }
}

TEST_F(TouchSurfaceTest, BlendsContinuouslyAcrossEdgesWithWeightsThatSumToOne) {
  std::vector<test::TouchableBody::Active> active;
  for (const Eigen::Vector3d& x :
       {Eigen::Vector3d(0.05, 0.05, 0.1), Eigen::Vector3d(0.1, 0.05, 0.05),
        Eigen::Vector3d(0, 0, 0.1), Eigen::Vector3d(0.1, 0.1, 0.1)})
    active.push_back({nodeAt(cube, x)});
  const TouchSurface surface(sealed({cube, active}), 0.2);
  int edges = 0;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(surface.triangles().size()); ++t)
    for (int c = 0; c < 3; ++c) {
      const std::int32_t other = surface.neighbor(t, c);
      ASSERT_GE(other, 0);
      if (!surface.touchable(t) || !surface.touchable(other)) continue;
      ++edges;
      const Triangle &a = surface.triangles()[static_cast<std::size_t>(t)],
                     &b = surface.triangles()[static_cast<std::size_t>(other)];
      SurfacePoint here{t, Eigen::Vector3d::Zero()}, there{other, Eigen::Vector3d::Zero()};
      here.barycentric[(c + 1) % 3] = 0.3;
      here.barycentric[(c + 2) % 3] = 0.7;
      for (int d = 0; d < 3; ++d)
        for (int e = 0; e < 3; ++e)
          if (a[static_cast<std::size_t>(d)] == b[static_cast<std::size_t>(e)])
            there.barycentric[e] = here.barycentric[d];
      EXPECT_NEAR(there.barycentric.sum(), 1, 1e-15);
      const SpaceBlend mine = surface.blendAt(here), theirs = surface.blendAt(there);
      double sum = 0;
      for (std::int32_t s = 0; s < 4; ++s) {
        EXPECT_NEAR(share(mine, s), share(theirs, s), 1e-15);
        sum += share(mine, s);
      }
      EXPECT_NEAR(sum, 1, 1e-14);
      EXPECT_LT((surface.position(here) - surface.position(there)).norm(), 1e-15);
      EXPECT_LT((surface.normal(here) - surface.normal(there)).norm(), 1e-14);
    }
  EXPECT_GT(edges, 100);
}

TEST_F(TouchSurfaceTest, HasGradientsOfBarycentricCoordinates) {
  const TouchSurface surface(sealed({test::blobMesh(), {{62}, {124}}}), 1);
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(surface.triangles().size()); ++t)
    for (Eigen::Index c = 0; c < 3; ++c)
      for (Eigen::Index d = 0; d < 3; ++d) {
        const Triangle& corners = surface.triangles()[static_cast<std::size_t>(t)];
        const Eigen::Vector3d edge =
            surface.vertices()[static_cast<std::size_t>(corners[static_cast<std::size_t>(d)])] -
            surface.vertices()[static_cast<std::size_t>(
                corners[static_cast<std::size_t>((d + 1) % 3)])];
        const double expected = (c == d ? 1 : 0) - (c == (d + 1) % 3 ? 1 : 0);
        EXPECT_NEAR(surface.barycentricGradients(t).col(c).dot(edge), expected, 1e-12);
        EXPECT_NEAR(surface.barycentricGradients(t).col(c).dot(surface.faceNormal(t)), 0, 1e-10);
      }
}

TEST_F(TouchSurfaceTest, TakesTheVerticesOfAQuadraticMesh) {
  const test::SampleDataset sample(PressureSpace::p1, DisplacementSpace::p2);
  sample.seal(directory.path() / "p2.h5");
  const Dataset dataset(directory.path() / "p2.h5");
  const TouchSurface surface(dataset);
  EXPECT_EQ(surface.vertices().size(), dataset.surfaceNodes().size());
  EXPECT_TRUE(std::ranges::any_of(surface.triangles(), [&surface](const Triangle& t) {
    return surface.touchable(static_cast<std::int32_t>(&t - surface.triangles().data()));
  }));
}

TEST_F(TouchSurfaceTest, NamesTheFileOfADatasetThatCannotBeTouched) {
  // The reach is shorter than every edge: no triangle has three corners near the active node.
  const Dataset dataset = sealed({cube, {{nodeAt(cube, {0.05, 0.05, 0.1})}}});
  test::expectError(ExitCode::failed, [&] { TouchSurface(dataset, 0.001); }, {"body.h5", "reach"});
  test::expectBadInput([&] { TouchSurface(dataset, -1); }, {"reach"});
}

TEST_F(TouchSurfaceTest, FindsTheNearestTouchablePoint) {
  const TouchSurface surface(sealed({cube, {{nodeAt(cube, {0.05, 0.05, 0.1})}}}));
  const NearestPoint nearest = surface.nearestTouchable({0.06, 0.05, 0.12});
  EXPECT_NEAR(nearest.distance, 0.02, 1e-12);
  EXPECT_TRUE(surface.touchable(nearest.triangle));
  EXPECT_LT((surface.position({nearest.triangle, nearest.barycentric}) - nearest.position).norm(),
            1e-15);
  EXPECT_TRUE(surface.touchable(surface.nearestTouchable({0.2, 0, 0}).triangle));
}

}  // namespace
}  // namespace palpate
