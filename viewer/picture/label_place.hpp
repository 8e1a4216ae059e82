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

/// Returns whether a box covers part of a line.
bool covers(const ScreenBox& box, const ThickLine& line);

/// Returns the place for the label of an arrow: beyond its tip, or beside it if the label would
/// cover something or not fit.
///
/// arrow: from tail to tip. size: of the label. view: contains the label. keep_clear, taken: not
/// covered if possible, like the arrow.
ScreenBox placeLabel(const ThickLine& arrow, const Eigen::Vector2d& size, const ScreenBox& view,
                     std::span<const ThickLine> keep_clear, std::span<const ScreenBox> taken = {});

}  // namespace palpate
