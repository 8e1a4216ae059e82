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

/// A square of 4 x 4 cells of 10 mm in the plane z = 0, seen from +z; its left half is touchable.
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
  std::vector<float> u(3 * square.vertices.size(), 0.0F);
  for (std::size_t n = 0; n < square.vertices.size(); ++n)
    u[3 * n + 2] = 0.3F * static_cast<float>(square.vertices[n].x());
  shape.setDisplacements(u);
  const Eigen::Vector3f expected = Eigen::Vector3f(-0.3F, 0, 1).normalized();
  for (std::size_t n = 0; n < shape.size(); ++n) {
    const auto column = static_cast<Eigen::Index>(n);
    EXPECT_NEAR((shape.normals().col(column) - expected).norm(), 0, 1e-5);
    EXPECT_NEAR(shape.positions()(2, column), 0.3F * shape.positions()(0, column), 1e-7)
        << "flat parts stay flat between vertices";
  }
}

Bytes bytesAt(const SurfaceShape& shape, std::size_t vertex) {
  return std::bit_cast<Bytes>(shape.colours()[vertex]);
}

void expectColour(const Bytes& found, const Rgb& expected) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(found[i], expected[i], 2);
}

/// The legend uses the same function.
TEST(SurfaceShape, ColoursLengthsOverTissueAsTheLegendDoes) {
  const Square square;
  SurfaceShape shape(square.vertices, square.triangles,
                     std::vector<bool>(square.triangles.size(), true));
  std::vector<float> u(3 * square.vertices.size(), 0.0F);
  u[2] = 0.004F;          // vertex 0: 4 mm
  u[3 * 5 + 1] = 0.009F;  // vertex 5: beyond the end of the scale
  shape.setDisplacements(u);
  shape.colourDisplacements(0.008);
  EXPECT_FLOAT_EQ(static_cast<float>(shape.largest()), 0.009F);
  expectColour(bytesAt(shape, 0), displacementColour(0.5, tissueColour(1)));
  expectColour(bytesAt(shape, 5), displacementColour(1, tissueColour(1)));
  const Bytes rest = bytesAt(shape, 12);
  shape.colourTissue();
  EXPECT_EQ(bytesAt(shape, 12), rest) << "places at rest show tissue";
  EXPECT_EQ(rest[3], 255) << "and wet";
}

TEST(SurfaceShape, ColoursPlacesByViridisAndOthersAsTissue) {
  SurfaceShape shape = Square().shape();
  std::vector<float> places(25, std::numeric_limits<float>::quiet_NaN());
  places[3] = 0.5F;
  places[7] = 2;
  ASSERT_GT(shape.size(), places.size()) << "it is rounded";
  shape.colourPlaces(places);
  const std::vector<std::uint32_t> covered(shape.colours().begin(), shape.colours().end());
  shape.colourTissue();
  int coloured = 0;  // vertices between two others have the mean, or none
  for (std::size_t v = 0; v < shape.size(); ++v) coloured += covered[v] != shape.colours()[v];
  shape.colourPlaces(places);
  EXPECT_EQ(coloured, 2);
  expectColour(bytesAt(shape, 3), viridis(0.5));
  expectColour(bytesAt(shape, 7), viridis(1));
  const Bytes none = bytesAt(shape, 8);
  shape.colourTissue();
  EXPECT_EQ(bytesAt(shape, 8), none);
}

TEST(SurfaceShape, ColoursPressuresOnBothSidesOfZeroAsTheLegendDoes) {
  SurfaceShape shape = Square().shape();
  std::vector<float> pressures(25, std::numeric_limits<float>::quiet_NaN());
  pressures[3] = 1000;
  pressures[7] = -4000;
  pressures[12] = 0;
  pressures[24] = 9000;  // beyond the end of the scale
  shape.colourPressures(pressures, 4000);
  expectColour(bytesAt(shape, 3), pressureColour(0.25));
  expectColour(bytesAt(shape, 7), pressureColour(-1));
  expectColour(bytesAt(shape, 12), pressureColour(0));
  expectColour(bytesAt(shape, 24), pressureColour(1));
  const Bytes none = bytesAt(shape, 8);
  shape.colourTissue();
  EXPECT_EQ(bytesAt(shape, 8), none) << "places without a pressure show tissue";
}

/// An added vertex in the middle of an edge has the mean pressure of the edge's ends, as a mid-edge
/// node of quadratic elements has.
TEST(SurfaceShape, HasTheMeanPressureInTheMiddleOfAnEdge) {
  const Square square;
  SurfaceShape shape = square.shape();
  ASSERT_GT(shape.size(), square.vertices.size()) << "it is rounded";
  std::vector<float> pressures(25, 0.0F);
  pressures[0] = 1000;
  shape.colourPressures(pressures, 1000);
  const Eigen::Vector3f middle = 0.5F * (shape.rest().col(0) + shape.rest().col(1));
  std::size_t found = 0;
  for (std::size_t v = 25; v < shape.size(); ++v)
    if ((shape.rest().col(static_cast<Eigen::Index>(v)) - middle).norm() < 1e-6F) found = v;
  ASSERT_GT(found, 0u);
  expectColour(bytesAt(shape, found), pressureColour(0.5));
}

TEST(SurfaceShape, FadesTheTouchablePartAtItsBorder) {
  const Square square;
  SurfaceShape shape = square.shape();
  EXPECT_EQ(shape.felt()[0], 1) << "two columns from the border";
  EXPECT_LT(shape.felt()[4], 0.05F);
  float last = 1;
  for (std::size_t column = 0; column < 5; ++column) {
    EXPECT_LE(shape.felt()[10 + column], last);
    EXPECT_LT(last - shape.felt()[10 + column], 0.6F) << "no jump";
    last = shape.felt()[10 + column];
  }
  const auto redness = [](Bytes c) { return c[0] - c[1]; };
  EXPECT_GT(redness(bytesAt(shape, 0)), redness(bytesAt(shape, 4)) + 20);
}

TEST(SurfaceShape, TreatsValuesThatAreNotFiniteAsAtRest) {
  SurfaceShape shape = Square().shape();
  std::vector<float> u(3 * 25, std::numeric_limits<float>::quiet_NaN());
  shape.setDisplacements(u);
  shape.colourDisplacements(0.01);
  EXPECT_EQ(shape.largest(), 0);
  EXPECT_EQ(shape.positions(), shape.rest());
}

TEST(SurfaceShape, RefusesMismatchedSizes) {
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
