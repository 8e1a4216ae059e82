#include "viewer/report/slice_picture.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

TEST(ColourScale, SpansWholeDecades) {
  const ColourScale scale({3e-3, 0.2, std::nan(""), 0, -1});
  EXPECT_NEAR(scale.lowest(), 1e-3, 1e-12);
  EXPECT_NEAR(scale.highest(), 1, 1e-12);
  EXPECT_EQ(scale.levelOf(1e-9), 0);
  EXPECT_EQ(scale.levelOf(0), 0);
  EXPECT_EQ(scale.levelOf(1e9), ColourScale::levels - 1);
  EXPECT_EQ(scale.levelOf(std::sqrt(1e-3)), ColourScale::levels / 2);
  std::vector<double> wide(100, 1e-12);
  std::fill(wide.begin() + 50, wide.end(), 1.0);
  EXPECT_NEAR(ColourScale(wide).lowest(), 1e-5, 1e-15);
  wide.assign(100, 0.05);
  wide[0] = 1e-9;
  wide[1] = 1e9;
  EXPECT_NEAR(ColourScale(wide).highest(), 0.1, 1e-12);
  EXPECT_NEAR(ColourScale({1.0}).lowest(), 0.1, 1e-12);
  EXPECT_GT(ColourScale({}).highest(), ColourScale({}).lowest());
}

TEST(ColourScale, GoesFromDarkToLight) {
  EXPECT_EQ(ColourScale::colour(0), "#440154");
  EXPECT_EQ(ColourScale::colour(ColourScale::levels - 1), "#fde725");
}

}  // namespace
}  // namespace palpate
