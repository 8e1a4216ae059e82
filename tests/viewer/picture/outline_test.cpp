#include "viewer/picture/outline.hpp"

#include <gtest/gtest.h>

#include <map>

#include "tests/support/meshes.hpp"
#include "viewer/picture/contour.hpp"
#include "viewer/picture/surface_shape.hpp"

namespace palpate {
namespace {

/// An octahedron, refined three times onto the unit ball: its outline is known.
struct UnitBall {
  std::vector<Eigen::Vector3d> vertices = {{1, 0, 0},  {-1, 0, 0}, {0, 1, 0},
                                           {0, -1, 0}, {0, 0, 1},  {0, 0, -1}};
  std::vector<Triangle> triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                     {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  UnitBall() {
    for (int round = 0; round < 3; ++round) refine();
  }
  void refine() {
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
    const auto middle = [&](std::int32_t a, std::int32_t b) {
      const auto [found, added] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                      static_cast<std::int32_t>(vertices.size()));
      if (added)
        vertices.push_back(
            (vertices[static_cast<std::size_t>(a)] + vertices[static_cast<std::size_t>(b)])
                .normalized());
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = finer;
  }
  SurfaceShape shape() const {
    return {vertices, triangles, std::vector<bool>(triangles.size(), true)};
  }
};

std::vector<OutlinePoint> outlineOf(const SurfaceShape& shape, const Eigen::Vector3f& eye,
                                    const std::vector<float>& shares) {
  std::vector<OutlinePoint> points;
  findOutline(shape.rest(), shape.restNormals(), shape.corners(), shares, eye, points);
  return points;
}

TEST(Outline, OfABallIsTheCircleWhereTheSightTouchesIt) {
  const SurfaceShape ball = UnitBall().shape();
  const float distance = 4;
  const std::vector<OutlinePoint> points =
      outlineOf(ball, {0, 0, distance}, std::vector<float>(ball.size(), 1));
  ASSERT_GT(points.size(), 40U);
  for (const OutlinePoint& point : points) {
    EXPECT_NEAR(point.place.z(), 1 / distance, 0.03);
    EXPECT_NEAR(point.place.head<2>().norm(), std::sqrt(1 - 1 / (distance * distance)), 0.03);
  }
}

TEST(Outline, IsClosed) {
  const SurfaceShape ball = UnitBall().shape();
  const std::vector<OutlinePoint> points =
      outlineOf(ball, {1.1F, 2.3F, 4.7F}, std::vector<float>(ball.size(), 1));
  ASSERT_GT(points.size(), 40U);
  for (std::size_t n = 0; n < points.size(); ++n) {
    int others = 0;  // of other lines, that end there too
    for (std::size_t m = 0; m < points.size(); ++m)
      others += m / 2 != n / 2 && (points[m].place - points[n].place).norm() < 1e-5F;
    EXPECT_GE(others, 1) << n;
  }
}

TEST(Outline, FadesWithTheSharesAndEndsWhereThereAreNone) {
  const SurfaceShape ball = UnitBall().shape();
  std::vector<float> shares(ball.size());
  for (std::size_t v = 0; v < ball.size(); ++v)
    shares[v] = std::max(0.0F, ball.rest()(0, static_cast<Eigen::Index>(v)));
  const std::vector<OutlinePoint> points = outlineOf(ball, {0, 0, 9}, shares);
  ASSERT_FALSE(points.empty());
  for (const OutlinePoint& point : points) {
    EXPECT_NEAR(point.share, std::max(0.0F, point.place.x()), 0.1);
    EXPECT_GT(point.place.x(), -0.3);
  }
}

TEST(Contour, IsWhereTrianglesThatFaceTheEyeMeetOthers) {
  const UnitBall ball;
  std::vector<std::uint32_t> corners;
  for (const Triangle& t : ball.triangles) corners.insert(corners.end(), t.begin(), t.end());
  Eigen::Matrix3Xf positions(3, std::ssize(ball.vertices));
  for (Eigen::Index v = 0; v < positions.cols(); ++v)
    positions.col(v) = ball.vertices[static_cast<std::size_t>(v)].cast<float>();
  Contour contour(corners);
  const std::span<const std::uint32_t> edges = contour.edges(positions, {0.1F, 0.2F, 50});
  ASSERT_GT(edges.size(), 2U * 20U);
  std::map<std::uint32_t, int> ends;
  for (const std::uint32_t vertex : edges) {
    EXPECT_LT(std::abs(positions(2, vertex)), 0.3F) << "near the circle that is seen as its rim";
    ++ends[vertex];
  }
  for (const auto& [vertex, count] : ends) EXPECT_EQ(count % 2, 0) << "closed";
}

}  // namespace
}  // namespace palpate
