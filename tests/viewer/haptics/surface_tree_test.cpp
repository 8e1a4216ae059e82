#include "viewer/haptics/surface_tree.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

class Random {
 public:
  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(engine_()) + 0.5) / 4294967296.0;
  }
  Eigen::Vector3d in(const Eigen::AlignedBox3d& box) {
    return {uniform(box.min().x(), box.max().x()), uniform(box.min().y(), box.max().y()),
            uniform(box.min().z(), box.max().z())};
  }

 private:
  std::mt19937 engine_{20};
};

Eigen::AlignedBox3d around(const Mesh& mesh, double margin) {
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  return {box.min() - margin * box.sizes(), box.max() + margin * box.sizes()};
}

SurfaceTree treeOf(const Mesh& mesh) { return {mesh.nodes, mesh.surface}; }

/// The distance to dense samples of each triangle: never below the true distance, and little above
/// it.
double sampledDistance(const Mesh& mesh, const Eigen::Vector3d& point) {
  double best = 1e9;
  constexpr int n = 60;
  for (const Triangle& t : mesh.surface) {
    const Eigen::Vector3d &a = mesh.nodes[t[0]], &b = mesh.nodes[t[1]], &c = mesh.nodes[t[2]];
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j)
        best = std::min(best, (point - (a + i * (b - a) / n + j * (c - a) / n)).squaredNorm());
  }
  return std::sqrt(best);
}

/// Solid angle of the surface around a point (van Oosterom and Strackee): 4 pi inside, 0 outside.
bool isInside(const Mesh& mesh, const Eigen::Vector3d& point) {
  double angle = 0;
  for (const Triangle& t : mesh.surface) {
    const Eigen::Vector3d a = mesh.nodes[t[0]] - point, b = mesh.nodes[t[1]] - point,
                          c = mesh.nodes[t[2]] - point;
    angle +=
        2 * std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                              b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return angle > 2 * M_PI;
}

/// A notch makes edges and vertices of every kind: convex, concave, and saddles.
Mesh notchedMesh() {
  Mesh mesh = test::cubeMesh(0.1, 4);
  std::erase_if(mesh.tetrahedra, [&](const Tetrahedron& t) {
    Eigen::Vector3d center = Eigen::Vector3d::Zero();
    for (const std::int32_t node : t) center += mesh.nodes[node] / 4;
    return center.x() > 0.05 && center.z() > 0.05;
  });
  finishMesh(mesh, "a cube with a notch");
  return mesh;
}

void expectRight(const NearestPoint& nearest, const Mesh& mesh, const Eigen::Vector3d& point) {
  ASSERT_GE(nearest.triangle, 0);
  const Triangle& t = mesh.surface[nearest.triangle];
  EXPECT_GE(nearest.barycentric.minCoeff(), 0);
  EXPECT_NEAR(nearest.barycentric.sum(), 1, 1e-14);
  const Eigen::Vector3d position = nearest.barycentric[0] * mesh.nodes[t[0]] +
                                   nearest.barycentric[1] * mesh.nodes[t[1]] +
                                   nearest.barycentric[2] * mesh.nodes[t[2]];
  EXPECT_LT((position - nearest.position).norm(), 1e-15);
  EXPECT_NEAR((point - position).norm(), nearest.distance, 1e-15);
}

TEST(SurfaceTree, FindsTheNearestPoint) {
  for (const Mesh& mesh : {test::blobMesh(), notchedMesh()}) {
    const SurfaceTree tree = treeOf(mesh);
    Random random;
    for (int n = 0; n < 300; ++n) {
      const Eigen::Vector3d point = random.in(around(mesh, 0.3));
      const NearestPoint nearest = tree.nearest(point);
      expectRight(nearest, mesh, point);
      const double sampled = sampledDistance(mesh, point);
      EXPECT_LE(nearest.distance, sampled + 1e-15);
      EXPECT_GE(nearest.distance, sampled - 0.001);
    }
  }
}

TEST(SurfaceTree, FindsTheSameFromAnyHint) {
  const Mesh mesh = test::blobMesh(6);
  const SurfaceTree tree = treeOf(mesh);
  Random random;
  for (int n = 0; n < 3000; ++n) {
    const Eigen::Vector3d point = random.in(around(mesh, 0.3));
    const auto hint =
        static_cast<std::int32_t>(random.uniform(0, static_cast<double>(mesh.surface.size())));
    const NearestPoint with = tree.nearest(point, hint), without = tree.nearest(point);
    EXPECT_EQ(with.distance, without.distance);
    EXPECT_EQ(with.outside, without.outside);
  }
}

TEST(SurfaceTree, SeparatesInsideFromOutsideNearFacesEdgesAndVertices) {
  for (const Mesh& mesh : {test::blobMesh(), notchedMesh(), test::tetrahedronMesh(0.1)}) {
    const SurfaceTree tree = treeOf(mesh);
    Random random;
    for (int n = 0; n < 3000; ++n) {
      Eigen::Vector3d point = random.in(around(mesh, 0.3));
      if (n % 2 == 0) {  // near a vertex
        const auto t =
            static_cast<std::size_t>(random.uniform(0, static_cast<double>(mesh.surface.size())));
        point = mesh.nodes[mesh.surface[t][0]] + 0.02 * (point - boundingBox(mesh).center());
      }
      EXPECT_EQ(tree.nearest(point).outside, !isInside(mesh, point)) << point.transpose();
    }
  }
}

TEST(SurfaceTree, CountsVerticesAsOutside) {
  const Mesh mesh = test::blobMesh();
  const SurfaceTree tree = treeOf(mesh);
  for (const std::int32_t node : surfaceNodes(mesh)) {
    const NearestPoint nearest = tree.nearest(mesh.nodes[node]);
    EXPECT_EQ(nearest.distance, 0);
    EXPECT_TRUE(nearest.outside);
  }
}

/// The first crossing from outside, found by testing every triangle by planes and sides, without a
/// tree.
double firstEntry(const Mesh& mesh, const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  double best = 2;
  const Eigen::Vector3d d = to - from;
  for (const Triangle& t : mesh.surface) {
    const Eigen::Vector3d &a = mesh.nodes[t[0]], &b = mesh.nodes[t[1]], &c = mesh.nodes[t[2]];
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    const double fraction = normal.dot(a - from) / normal.dot(d);
    if (!(normal.dot(d) < 0 && fraction >= 0 && fraction <= 1)) continue;
    const Eigen::Vector3d x = from + fraction * d;
    if (normal.dot((b - a).cross(x - a)) >= 0 && normal.dot((c - b).cross(x - b)) >= 0 &&
        normal.dot((a - c).cross(x - c)) >= 0)
      best = std::min(best, fraction);
  }
  return best;
}

TEST(SurfaceTree, FindsTheFirstEntryOfASegment) {
  for (const Mesh& mesh : {test::blobMesh(), notchedMesh()}) {
    const SurfaceTree tree = treeOf(mesh);
    Random random;
    int hits = 0;
    for (int n = 0; n < 5000; ++n) {
      const Eigen::Vector3d from = random.in(around(mesh, 0.3)), to = random.in(around(mesh, 0.3));
      const Crossing crossing = tree.entry(from, to);
      const double expected = firstEntry(mesh, from, to);
      ASSERT_EQ(crossing.triangle >= 0, expected <= 1);
      if (crossing.triangle < 0) continue;
      ++hits;
      EXPECT_NEAR(crossing.fraction, expected, 1e-12);
      EXPECT_GE(crossing.barycentric.minCoeff(), 0);
      EXPECT_NEAR(crossing.barycentric.sum(), 1, 1e-14);
      const Triangle& t = mesh.surface[crossing.triangle];
      const Eigen::Vector3d x = crossing.barycentric[0] * mesh.nodes[t[0]] +
                                crossing.barycentric[1] * mesh.nodes[t[1]] +
                                crossing.barycentric[2] * mesh.nodes[t[2]];
      EXPECT_LT((x - from - crossing.fraction * (to - from)).norm(), 1e-13);
    }
    EXPECT_GT(hits, 300);
  }
}

TEST(SurfaceTree, HasNoCracksAtEdgesAndVertices) {
  const Mesh mesh = test::blobMesh();
  const SurfaceTree tree = treeOf(mesh);
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  const Eigen::Vector3d center =
      tree.nearest(box.center()).outside ? Eigen::Vector3d(0, 0, 0) : box.center();
  ASSERT_TRUE(isInside(mesh, center));
  Random random;
  int leaks = 0;
  for (int n = 0; n < 100000; ++n) {
    const auto t =
        static_cast<std::size_t>(random.uniform(0, static_cast<double>(mesh.surface.size())));
    const Eigen::Vector3d &a = mesh.nodes[mesh.surface[t][0]], &b = mesh.nodes[mesh.surface[t][1]];
    const double share = n % 2 == 0 ? 0 : random.uniform(0, 1);
    const Eigen::Vector3d target = (1 - share) * a + share * b;
    const Eigen::Vector3d inside = center + 0.2 * (random.in(box)-center);
    const Eigen::Vector3d from = target + random.uniform(0.5, 2) * (target - inside);
    const NearestPoint start = tree.nearest(from);
    if (!start.outside || tree.nearest(inside).outside) continue;
    leaks += tree.entry(from, inside).triangle < 0 ? 1 : 0;
  }
  EXPECT_EQ(leaks, 0);
}

TEST(SurfaceTree, DoesNotCountAnExitAsAnEntry) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  EXPECT_EQ(treeOf(mesh).entry({0.05, 0.05, 0.05}, {0.05, 0.06, 0.2}).triangle, -1);
}

TEST(SurfaceTree, AnswersForAnEmptySurfaceAndAnEmptySegment) {
  EXPECT_EQ(SurfaceTree().nearest({0, 0, 0}).triangle, -1);
  EXPECT_EQ(SurfaceTree().entry({0, 0, 0}, {1, 0, 0}).triangle, -1);
  const Eigen::Vector3d point(0.05, 0.05, 0.1);
  EXPECT_EQ(treeOf(test::cubeMesh(0.1, 2)).entry(point, point).triangle, -1);
}

}  // namespace
}  // namespace palpate
