#include "viewer/fields/shape_modes.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

constexpr Eigen::Index width = 60;
constexpr float tolerance = 1e-3f;

/// Sums of `rank` fixed rows with random factors in [-1, 1].
ShapeRows shapesOfRank(Eigen::Index rank, Eigen::Index count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> spread(-1, 1);
  const auto any = [&] { return spread(random); };
  const ShapeRows parts = ShapeRows::NullaryExpr(rank, width, any);
  return ShapeRows(ShapeRows::NullaryExpr(count, rank, any) * parts);
}

float largestMiss(const ShapeRows& shapes, const ShapeRows& modes) {
  return (shapes - (shapes * modes.transpose()) * modes).cwiseAbs().maxCoeff();
}

TEST(ShapeModes, AreOrthonormalAndAsManyAsIndependentShapes) {
  const ShapeRows shapes = shapesOfRank(7, 3000);
  const ShapeRows modes = modesOf(shapes, tolerance);
  EXPECT_EQ(modes.rows(), 7);
  const ShapeRows products = modes * modes.transpose();
  EXPECT_TRUE(products.isIdentity(1e-5f)) << products;
  EXPECT_LE(largestMiss(shapes, modes), tolerance);
}

TEST(ShapeModes, SpanAnOutlierWhereverItStands) {
  for (const Eigen::Index where : {0, 1, 3, 1234, 2998, 2999}) {
    ShapeRows shapes = shapesOfRank(4, 3000);
    shapes.row(where) = Eigen::RowVectorXf::Unit(width, 5);
    const ShapeRows modes = modesOf(shapes, tolerance);
    EXPECT_EQ(modes.rows(), 5) << where;
    EXPECT_LE(largestMiss(shapes, modes), tolerance) << where;
  }
}

TEST(ShapeModes, RepresentEveryEntryOfUncorrelatedShapes) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> spread(-1, 1);
  ShapeRows shapes = shapesOfRank(3, 2000);
  shapes += 3 * tolerance * ShapeRows::NullaryExpr(2000, width, [&] { return spread(random); });
  const ShapeRows modes = modesOf(shapes, tolerance);
  EXPECT_GT(modes.rows(), 3);
  EXPECT_LE(modes.rows(), width);
  EXPECT_LE(largestMiss(shapes, modes), 1.001f * tolerance);
}

/// Regression: the search did not end.
TEST(ShapeModes, AreNoMoreThanSinglePrecisionDistinguishes) {
  const ShapeRows shapes = 1e6f * shapesOfRank(7, 3000);
  const ShapeRows modes = modesOf(shapes, tolerance);
  EXPECT_EQ(modes.rows(), 7);
  EXPECT_LE(largestMiss(shapes, modes), 1e-5f * shapes.cwiseAbs().maxCoeff());
}

TEST(ShapeModes, AreEmptyForShapesAtRest) {
  EXPECT_EQ(modesOf(ShapeRows::Zero(500, width), tolerance).rows(), 0);
}

}  // namespace
}  // namespace palpate
