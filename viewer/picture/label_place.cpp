#include "viewer/picture/label_place.hpp"

#include <algorithm>
#include <array>

namespace palpate {
namespace {

constexpr double gap = 8;           // px, distance between the tip and the label
constexpr double least_length = 4;  // px: a shorter arrow has no visible direction
constexpr int samples_of_a_line = 24;
/// Factors on the label's distance from the tip (boxBeyondTip), tried in this order.
constexpr std::array reaches = {1.0, 1.8, 3.0, 5.0, 8.0, 12.0};

bool overlap(const ScreenBox& a, const ScreenBox& b) {
  return (a.from.array() < b.to.array()).all() && (b.from.array() < a.to.array()).all();
}

}  // namespace

bool covers(const ScreenBox& box, const ThickLine& line) {
  for (int n = 0; n <= samples_of_a_line; ++n) {
    const Eigen::Vector2d point =
        line.from + n / static_cast<double>(samples_of_a_line) * (line.to - line.from);
    const Eigen::Vector2d nearest = point.cwiseMax(box.from).cwiseMin(box.to);
    if ((point - nearest).norm() <= line.radius) return true;
  }
  return false;
}

ScreenBox placeLabel(const ThickLine& arrow, const Eigen::Vector2d& size, const ScreenBox& view,
                     std::span<const ThickLine> keep_clear, std::span<const ScreenBox> taken) {
  const Eigen::Vector2d along = arrow.to - arrow.from;
  const Eigen::Vector2d ahead =
      along.norm() > least_length ? Eigen::Vector2d(along.normalized()) : Eigen::Vector2d(0, -1);
  const Eigen::Vector2d right(-ahead.y(), ahead.x());
  const auto boxBeyondTip = [&](const Eigen::Vector2d& direction, double reach) {
    const double away =
        arrow.radius + gap * reach + (reach - 1) * size.y() + 0.5 * direction.cwiseAbs().dot(size);
    const Eigen::Vector2d corner = arrow.to + away * direction - size / 2;
    const Eigen::Vector2d inside = corner.cwiseMin(view.to - size).cwiseMax(view.from);
    return ScreenBox{inside, inside + size};
  };
  const auto isClear = [&](const ScreenBox& box) {
    return !covers(box, arrow) &&
           std::ranges::none_of(keep_clear, [&](const auto& line) { return covers(box, line); }) &&
           std::ranges::none_of(taken, [&](const auto& other) { return overlap(box, other); });
  };
  for (const double reach : reaches)
    for (const Eigen::Vector2d& direction : {ahead, Eigen::Vector2d((ahead + right).normalized()),
                                             Eigen::Vector2d((ahead - right).normalized()), right,
                                             Eigen::Vector2d(-right), Eigen::Vector2d(-ahead)})
      if (ScreenBox box = boxBeyondTip(direction, reach); isClear(box)) return box;
  return boxBeyondTip(ahead, 1);
}

}  // namespace palpate
