#pragma once

#include <Eigen/Core>
#include <span>

namespace palpate {

/// A rectangle on the screen, pixels, y downward.
struct ScreenBox {
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
};

/// A line with round ends that a label must not cover, pixels.
struct ThickLine {
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
  double radius = 0;
};

/// Whether a box covers any of a line.
bool covers(const ScreenBox& box, const ThickLine& line);

/// Where the label of an arrow goes: beyond its tip, along it; where that covers something or does
/// not fit, beside it. arrow: from its tail to its tip. size: of the label. view: it stays inside.
/// keep_clear, taken: with the arrow, what it does not cover where that is possible.
ScreenBox placeLabel(const ThickLine& arrow, const Eigen::Vector2d& size, const ScreenBox& view,
                     std::span<const ThickLine> keep_clear, std::span<const ScreenBox> taken = {});

}  // namespace palpate
