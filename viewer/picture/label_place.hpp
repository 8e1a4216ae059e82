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

/// Returns the place for the label of an arrow. It is beyond the tip of the arrow, or beside the
/// tip if the label would cover something there or would not fit.
///
/// arrow: from its tail to its tip. size: size of the label. view: the label stays inside.
/// keep_clear, taken: the label covers neither these nor the arrow, if that is possible.
ScreenBox placeLabel(const ThickLine& arrow, const Eigen::Vector2d& size, const ScreenBox& view,
                     std::span<const ThickLine> keep_clear, std::span<const ScreenBox> taken = {});

}  // namespace palpate
