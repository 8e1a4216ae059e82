#include "viewer/picture/tissue_colours.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "viewer/plot/viridis.hpp"

namespace palpate {
namespace {

double lightness(const Rgb& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

TEST(TissueColours, AreReddishAndPalerOutsideTheTouchablePart) {
  const Rgb felt = tissueColour(1), none = tissueColour(0);
  EXPECT_GT(felt[0], 2 * felt[1]);
  EXPECT_GT(lightness(none), lightness(felt) + 30);
  EXPECT_GT(none[0], none[2]) << "still tissue";
  for (const double blotch : {0.0, 1.0})
    EXPECT_LT(std::abs(lightness(tissueColour(1, blotch)) - lightness(felt)), 15);
}

TEST(TissueColours, GoFromTissueToViridisGrowingLighter) {
  const Rgb tissue = tissueColour(1);
  EXPECT_EQ(displacementColour(0, tissue), tissue);
  EXPECT_EQ(displacementColour(1, tissue), viridis(1));
  EXPECT_EQ(displacementColour(3, tissue), viridis(1));
  double last = 0;
  for (int n = 0; n <= 50; ++n) {
    const double now = lightness(displacementColour(n / 50.0, tissue));
    EXPECT_GT(now, last - 0.5) << n;
    last = now;
  }
}

TEST(TissueColours, HaveBlotchesBetweenTheirEnds) {
  for (int n = 0; n < 200; ++n) {
    const double blotch = blotchAt({std::sin(n * 1.0), std::cos(n * 2.0), std::sin(n * 3.0)});
    EXPECT_GE(blotch, 0);
    EXPECT_LE(blotch, 1);
  }
}

/// The eye should recognise zero, and equal distances from it in both directions.
TEST(PressureColours, AreLightAtZeroAndDarkenBothWays) {
  const Rgb none = pressureColour(0);
  EXPECT_EQ(none[0], none[1]);
  EXPECT_EQ(none[1], none[2]);
  for (const double sign : {-1.0, 1.0}) {
    double last = lightness(none) + 1;
    for (int n = 0; n <= 20; ++n) {
      const double now = lightness(pressureColour(sign * n / 20.0));
      EXPECT_LT(now, last) << sign * n / 20.0;
      last = now;
    }
    EXPECT_EQ(pressureColour(sign), pressureColour(3 * sign));
  }
}

TEST(PressureColours, ArePurpleInCompressionAndGreenInTension) {
  for (const double place : {0.25, 0.5, 1.0}) {
    const Rgb compressed = pressureColour(place), stretched = pressureColour(-place);
    EXPECT_GT(std::min(compressed[0], compressed[2]), compressed[1] + 10);
    EXPECT_GT(stretched[1], std::max(stretched[0], stretched[2]) + 10);
  }
}

TEST(SurfaceColour, CyclesThroughAllAvailableColourings) {
  SurfaceColour colour = SurfaceColour::tissue;
  for (int n = 0; n < surface_colour_count; ++n) {
    EXPECT_STRNE(surface_colours.at(static_cast<std::size_t>(colour)), "");
    colour = following(colour);
  }
  EXPECT_EQ(colour, SurfaceColour::tissue);
}

}  // namespace
}  // namespace palpate
