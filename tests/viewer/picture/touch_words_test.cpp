#include "viewer/picture/touch_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "viewer/fields/relative_error.hpp"

namespace palpate {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

HapticState touchedWith(double force, double bound) {
  HapticState state;
  state.touch.touching = true;
  state.touch.force = state.force = {0, 0, force};
  state.touch.error_bound = bound;
  return state;
}

TEST(TouchWords, CallAForceUncertainWhenAHandCouldNoticeTheError) {
  EXPECT_FALSE(isUncertain(touchedWith(1, 0.9 * noticeable_force_error).touch));
  EXPECT_TRUE(isUncertain(touchedWith(1, 1.1 * noticeable_force_error).touch));
  EXPECT_FALSE(isUncertain(touchedWith(0.001, 0.0002).touch)) << "nothing that a hand feels";
  EXPECT_FALSE(isUncertain(touchedWith(1, std::numeric_limits<double>::quiet_NaN()).touch));
  EXPECT_FALSE(isUncertain(Touch()));
}

TEST(TouchWords, SayForceAndBoundAndOnceThatItIsUncertain) {
  EXPECT_EQ(forceText(touchedWith(0.402, 0.016)), "0.40 N ± 0.016 N");
  EXPECT_THAT(forceText(touchedWith(1, 0.2)), HasSubstr("uncertain: ± 20 %, a hand notices 7 %"));
  EXPECT_EQ(forceText(touchedWith(1, std::numeric_limits<double>::quiet_NaN())), "1.00 N");
  EXPECT_EQ(forceText(HapticState()), "");
}

TEST(TouchWords, GiveNoBoundToAWallAndSayThatItIsOne) {
  HapticState state = touchedWith(1, 0.001);
  state.touch.inside = false;
  EXPECT_TRUE(isUncertain(state.touch));
  EXPECT_THAT(forceText(state), HasSubstr("deeper than was computed"));
  EXPECT_THAT(forceText(state), Not(HasSubstr("±")));
}

TEST(TouchWords, SayWhyNothingIsTouchedBesideAndThatItIsNotToTheSameScale) {
  EXPECT_THAT(untouchedText(true, true), HasSubstr("Nothing was computed here"));
  EXPECT_THAT(untouchedText(false, false), HasSubstr("not to the same scale"));
  EXPECT_THAT(untouchedText(false, true), HasSubstr("Another body: it cannot be touched"));
}

TEST(TouchWords, NameTheTissue) {
  Region liver;
  liver.material.c10 = 500;
  liver.material.c01 = 100;
  EXPECT_EQ(tissueText({liver}), "Mooney-Rivlin, Young's modulus 3.6 kPa");
  EXPECT_THAT(tissueText({liver, liver}), HasSubstr("and 1 other material"));
  EXPECT_THAT(tissueText({liver, liver, liver}), HasSubstr("2 other materials"));
}

}  // namespace
}  // namespace palpate
