#include "viewer/picture/label_place.hpp"

#include <gtest/gtest.h>

#include <array>
#include <numbers>

namespace palpate {
namespace {

constexpr double label_wide = 120, label_high = 22;
const ScreenBox whole_view = {{4, 4}, {976, 618}};

ScreenBox labelOfArrow(const ThickLine& arrow, std::span<const ThickLine> clear = {},
                       std::span<const ScreenBox> taken = {}) {
  return placeLabel(arrow, {label_wide, label_high}, whole_view, clear, taken);
}

TEST(LabelPlace, IsBeyondTheTipOfAnArrowInAnyDirection) {
  for (int n = 0; n < 16; ++n) {
    const double angle = 2 * std::numbers::pi * n / 16;
    const Eigen::Vector2d along(std::cos(angle), std::sin(angle)), middle(480, 300);
    const ThickLine arrow = {middle, middle + 90 * along, 6};
    const ScreenBox box = labelOfArrow(arrow);
    EXPECT_FALSE(covers(box, arrow)) << n;
    EXPECT_GT(((box.from + box.to) / 2 - arrow.to).dot(along), 0) << n;
    EXPECT_NEAR(box.to.x() - box.from.x(), label_wide, 1e-9);
  }
}

TEST(LabelPlace, IsClearOfTheTool) {
  const ThickLine arrow = {{480, 300}, {480, 230}, 6};
  const std::array<ThickLine, 1> tool = {{{{480, 260}, {500, 120}, 30}}};
  const ScreenBox box = labelOfArrow(arrow, tool);
  EXPECT_FALSE(covers(box, arrow));
  EXPECT_FALSE(covers(box, tool[0]));
}

TEST(LabelPlace, StaysInTheViewClearOfTheArrow) {
  for (const Eigen::Vector2d& tip : {Eigen::Vector2d(970, 300), Eigen::Vector2d(480, 8),
                                     Eigen::Vector2d(10, 612), Eigen::Vector2d(970, 10)}) {
    const ThickLine arrow = {{480, 300}, tip, 6};
    const ScreenBox box = labelOfArrow(arrow);
    EXPECT_FALSE(covers(box, arrow)) << tip.transpose();
    EXPECT_GE(box.from.x(), whole_view.from.x());
    EXPECT_GE(box.from.y(), whole_view.from.y());
    EXPECT_LE(box.to.x(), whole_view.to.x());
    EXPECT_LE(box.to.y(), whole_view.to.y());
  }
}

TEST(LabelPlace, IsAboveAnArrowThatPointsTowardTheEye) {
  const ThickLine arrow = {{480, 300}, {481, 300}, 6};
  const ScreenBox box = labelOfArrow(arrow);
  EXPECT_FALSE(covers(box, arrow));
  EXPECT_LT(box.to.y(), 300);
}

TEST(LabelPlace, IsClearOfLegends) {
  const ScreenBox legend = {{18, 400}, {120, 610}};
  const ThickLine arrow = {{270, 425}, {150, 450}, 6};
  const ScreenBox box = labelOfArrow(arrow, {}, std::array{legend});
  EXPECT_FALSE(covers(box, arrow));
  EXPECT_LT(((box.from + box.to) / 2 - arrow.to).norm(), 150) << "and still near the arrow";
  EXPECT_TRUE((box.from.array() > legend.to.array()).any() ||
              (box.to.array() < legend.from.array()).any());
}

TEST(LabelPlace, ABoxCoversThickLinesThatTouchIt) {
  const ScreenBox box = {{0, 0}, {10, 10}};
  EXPECT_TRUE(covers(box, {{-5, 5}, {15, 5}, 0}));
  EXPECT_TRUE(covers(box, {{12, 5}, {30, 5}, 3}));
  EXPECT_FALSE(covers(box, {{12, 5}, {30, 5}, 1}));
}

}  // namespace
}  // namespace palpate
