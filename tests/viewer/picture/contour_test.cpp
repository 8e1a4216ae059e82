#include "viewer/picture/contour.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

namespace palpate {
namespace {

constexpr std::array<std::uint32_t, 24> octahedron = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                                      2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};

using Edges = std::set<std::array<std::uint32_t, 2>>;

/// The edges of the contour, each from the vertex of lower index.
Edges contourFrom(const Eigen::Vector3f& eye) {
  Eigen::Matrix3Xf positions(3, 6);
  positions << 1, -1, 0, 0, 0, 0,  //
      0, 0, 1, -1, 0, 0,           //
      0, 0, 0, 0, 1, -1;
  Contour contour(octahedron);
  const std::span<const std::uint32_t> edges = contour.edges(positions, eye);
  Edges found;
  for (std::size_t n = 0; n < edges.size(); n += 2)
    found.insert({std::min(edges[n], edges[n + 1]), std::max(edges[n], edges[n + 1])});
  EXPECT_EQ(2 * found.size(), edges.size()) << "each once";
  return found;
}

TEST(Contour, SeparatesTrianglesThatFaceTheEyeFromOthers) {
  EXPECT_EQ(contourFrom({0.1F, 0.2F, 50}), (Edges{{0, 2}, {1, 2}, {1, 3}, {0, 3}}));
  EXPECT_EQ(contourFrom({50, 50, 50}), (Edges{{0, 3}, {0, 5}, {1, 2}, {1, 4}, {2, 5}, {3, 4}}));
}

}  // namespace
}  // namespace palpate
