#include "viewer/picture/surface_shape.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

using Bytes = std::array<std::uint8_t, 4>;

/// A square of 4 x 4 cells of 10 mm in the plane z = 0, seen from +z; its left half can be touched.
struct Square {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Triangle> triangles;
  std::vector<bool> touchable;
  Square() {
    for (int j = 0; j < 5; ++j)
      for (int i = 0; i < 5; ++i) vertices.emplace_back(0.01 * i, 0.01 * j, 0);
    for (std::int32_t j = 0; j < 4; ++j)
      for (std::int32_t i = 0; i < 4; ++i) {
        const std::int32_t a = i + 5 * j;
        triangles.push_back({a, a + 1, a + 6});
        triangles.push_back({a, a + 6, a + 5});
        touchable.insert(touchable.end(), 2, i < 2);
      }
  }
  SurfaceShape shape() const { return {vertices, triangles, touchable}; }
};

TEST(SurfaceShape, HasTheNormalsOfTheDeformedSurface) {
  const Square square;
  SurfaceShape shape = square.shape();
  // z = 0.3 x: the normal is (-0.3, 0, 1), normalised.
  std::vector<float> u(3 * shape.size(), 0.0F);
  for (std::size_t n = 0; n < shape.size(); ++n)
    u[3 * n + 2] = 0.3F * static_cast<float>(square.vertices[n].x());
  shape.setDisplacements(u);
  const Eigen::Vector3f expected = Eigen::Vector3f(-0.3F, 0, 1).normalized();
  for (std::size_t n = 0; n < shape.size(); ++n) {
    const auto column = static_cast<Eigen::Index>(n);
    EXPECT_NEAR((shape.normals().col(column) - expected).norm(), 0, 1e-5);
    EXPECT_FLOAT_EQ(shape.positions()(2, column), u[3 * n + 2]);
  }
}

TEST(SurfaceShape, ColoursLengthsByViridisWhereItCanBeTouchedAndGreysTheRest) {
  SurfaceShape shape = Square().shape();
  std::vector<float> u(3 * shape.size(), 0.0F);
  u[2] = 0.004F;          // vertex 0: touchable, 4 mm
  u[3 * 4] = -0.004F;     // vertex 4: not touchable
  u[3 * 5 + 1] = 0.009F;  // vertex 5: beyond the end of the colours
  shape.setDisplacements(u);
  shape.setColours(0.008);
  EXPECT_FLOAT_EQ(static_cast<float>(shape.largest()), 0.009F);
  const auto at = [&](std::size_t n) { return std::bit_cast<Bytes>(shape.colours()[n]); };
  const std::array<double, 3> half = viridis(0.5), end = viridis(1), none = viridis(0);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(at(0)[i], half[i], 2);
    EXPECT_NEAR(at(5)[i], end[i], 1);
    EXPECT_NEAR(at(1)[i], none[i], 1);
  }
  const auto saturation = [](Bytes c) {
    return std::max({c[0], c[1], c[2]}) - std::min({c[0], c[1], c[2]});
  };
  EXPECT_GT(saturation(at(0)), 2 * saturation(at(4)));
}

TEST(SurfaceShape, FindsTheRimOfWhatCanBeTouched) {
  const SurfaceShape shape = Square().shape();
  // Around 2 x 4 cells; at the border of the square too.
  EXPECT_EQ(shape.rim().size(), 2U * 12U);
  EXPECT_EQ(shape.edges().size(), 2U * (4 * 5 * 2 + 16));
}

TEST(SurfaceShape, TakesWhatIsNotFiniteForAtRest) {
  SurfaceShape shape = Square().shape();
  std::vector<float> u(3 * shape.size(), std::numeric_limits<float>::quiet_NaN());
  shape.setDisplacements(u);
  shape.setColours(0.01);
  EXPECT_EQ(shape.largest(), 0);
  EXPECT_EQ(shape.positions(), shape.rest());
}

TEST(SurfaceShape, RefusesSizesThatDoNotFit) {
  SurfaceShape shape = Square().shape();
  EXPECT_THROW(shape.setDisplacements(std::vector<float>(7)), std::logic_error);
}

TEST(Viridis, EndsInDarkBlueAndYellowAndGrowsLighter) {
  EXPECT_EQ(viridis(0), (std::array<double, 3>{68, 1, 84}));
  EXPECT_EQ(viridis(2), (std::array<double, 3>{253, 231, 37}));
  EXPECT_EQ(viridis(std::nan("")), viridis(0));
  double last = -1;
  for (int n = 0; n <= 50; ++n) {
    const std::array<double, 3> c = viridis(n / 50.0);
    const double light = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    EXPECT_GT(light, last);
    last = light;
  }
}

}  // namespace
}  // namespace palpate
