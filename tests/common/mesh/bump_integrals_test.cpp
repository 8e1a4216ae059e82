#include "common/mesh/bump_integrals.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

double sumOf(const std::vector<BumpIntegral>& integrals) {
  return std::accumulate(
      integrals.begin(), integrals.end(), 0.0,
      [](double sum, const BumpIntegral& integral) { return sum + integral.value; });
}

/// The integral of the bump over a disk of radius R is pi R^2 / 3.
TEST(BumpIntegrals, SumUpToTheIntegralOfTheBumpOnAnyMesh) {
  for (const int cells : {1, 2, 7})
    for (const bool quadratic : {false, true})
      for (const double radius : {0.003, 0.09}) {
        Mesh mesh = test::cubeMesh(0.2, cells);
        if (quadratic) addMidEdgeNodes(mesh);
        const double exact = std::acos(-1.0) * radius * radius / 3;
        EXPECT_NEAR(sumOf(bumpIntegrals(mesh, {0.1, 0.1, 0.2}, radius)), exact, 1e-6 * exact)
            << cells << " cells, quadratic: " << quadratic << ", radius " << radius;
      }
}

/// A bump far wider than the triangle is 1 on it. A linear triangle then gives each vertex a third
/// of its area; a quadratic one gives a third to each mid-edge node and nothing to the vertices.
TEST(BumpIntegrals, EqualThoseOfTheShapeFunctionsUnderAFlatBump) {
  Mesh mesh = test::tetrahedronMesh(1e-4);
  mesh.surface = {{0, 1, 2}};
  const double area = 0.5e-8;
  const std::vector<BumpIntegral> linear = bumpIntegrals(mesh, {0, 0, 0}, 10);
  for (int n = 0; n < 3; ++n) EXPECT_NEAR(linear[n].value, area / 3, 1e-9 * area);
  EXPECT_EQ(linear[3].value, 0);
  addMidEdgeNodes(mesh);
  const std::vector<BumpIntegral> quadratic = bumpIntegrals(mesh, {0, 0, 0}, 10);
  for (int n = 0; n < 3; ++n) {
    EXPECT_NEAR(quadratic[n].value, 0, 1e-9 * area);
    EXPECT_NEAR(quadratic[midEdgeNode(mesh, n, (n + 1) % 3)].value, area / 3, 1e-9 * area);
  }
}

}  // namespace
}  // namespace palpate
