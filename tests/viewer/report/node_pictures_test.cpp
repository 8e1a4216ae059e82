#include "viewer/report/node_pictures.hpp"

#include <gtest/gtest.h>

#include <regex>

#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/report/slice_picture.hpp"

namespace palpate {
namespace {

SliceMap sampled(double radius, const std::vector<HeldOutSolution>& held_out = {}) {
  const SpaceTable space = test::solvedSpace(Lattice(radius, radius / 2), test::StiffeningEnergy());
  return sampleSlice(*makeForceField("potential", space), space, 0, 2, held_out);
}

TEST(SliceMap, ShowsLatticePointsOfThePlaneAndErrorsCloseToIt) {
  HeldOutSolution close, far;
  close.displacement = {0.003, 0.0005, -0.004};
  far.displacement = {0.003, 0.002, -0.004};
  const SliceMap map = sampled(0.02, {close, far});
  EXPECT_EQ(map.marks.size(), 13U);  // of 33
  ASSERT_EQ(map.errors.size(), 1U);
  EXPECT_EQ(map.errors[0].at, Eigen::Vector2d(0.003, -0.004));
  EXPECT_GT(map.errors[0].error, 0);
}

TEST(SliceMap, HasBoundsInTheBallAndKnowsWhatIsCovered) {
  const SliceMap map = sampled(0.02);
  const int middle = SliceMap::side / 2;
  EXPECT_TRUE(std::isnan(map.bound[SliceMap::sampleAt(0, 0)]));
  EXPECT_TRUE(std::isfinite(map.bound[SliceMap::sampleAt(middle, middle)]));
  EXPECT_TRUE(map.covered[SliceMap::sampleAt(middle, middle)]);
  EXPECT_FALSE(map.covered[SliceMap::sampleAt(0, middle)]);
}

/// Digits of the page's font are this part of its size wide; nothing it prints is wider.
constexpr double digit_width = 0.65 * 11.5;

TEST(SlicePicture, NumbersOfTheAxesAreNotCutOff) {
  for (const double radius : {0.02, 0.1, 0.1234}) {
    const std::string svg = svgOf(sampled(radius), ColourScale({1.0}));
    std::smatch size, number;
    ASSERT_TRUE(std::regex_search(svg, size, std::regex("viewBox=\"0 0 ([0-9.]+) ")));
    int numbers = 0;
    std::string rest = svg;
    const std::regex text("<text class=\"tick\" x=\"([0-9.]+)\"[^>]*anchor=\"(\\w+)\">([^<]+)<");
    for (; std::regex_search(rest, number, text); rest = number.suffix(), ++numbers) {
      const double x = std::stod(number[1]), width = digit_width * number[3].length();
      const double begin = number[2] == "end" ? x - width : x - width / 2;
      EXPECT_GE(begin, 0) << number[0];
      EXPECT_LE(begin + width, std::stod(size[1])) << number[0];
    }
    EXPECT_EQ(numbers, 6);
  }
}

}  // namespace
}  // namespace palpate
