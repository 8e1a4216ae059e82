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

std::string label(const HapticState& state) { return forceText(state.force, state.touch); }

TEST(TouchWords, CallAForceUncertainWhenAHandCouldNoticeTheError) {
  EXPECT_FALSE(isUncertain(touchedWith(1, 0.9 * noticeable_force_error).touch));
  EXPECT_TRUE(isUncertain(touchedWith(1, 1.1 * noticeable_force_error).touch));
  EXPECT_FALSE(isUncertain(touchedWith(0.001, 0.0002).touch)) << "an error that no hand feels";
  EXPECT_FALSE(isUncertain(touchedWith(1, std::numeric_limits<double>::quiet_NaN()).touch));
  EXPECT_FALSE(isUncertain(Touch()));
}

TEST(TouchWords, GiveForceAndBound) {
  EXPECT_EQ(label(touchedWith(0.402, 0.016)), "0.40 N ± 0.016 N");
  EXPECT_THAT(label(touchedWith(1, 0.2)), HasSubstr("± 20 %"));
  EXPECT_EQ(label(touchedWith(1, std::numeric_limits<double>::quiet_NaN())), "1.00 N");
  EXPECT_EQ(label(HapticState()), "");
}

TEST(TouchWords, GiveNoBoundOutsideTheComputedRegion) {
  HapticState state = touchedWith(1, 0.001);
  state.touch.inside = false;
  EXPECT_TRUE(isUncertain(state.touch));
  EXPECT_THAT(label(state), Not(HasSubstr("±")));
}

}  // namespace
}  // namespace palpate
