#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/markup.hpp"

namespace palpate {

/// One axis of a plot; it fits the data.
struct PlotAxis {
  std::string label;
  bool logarithmic = false;  ///< values that are not above zero are then left out
};

/// How a curve looks. Colours of seriesStyle can be told apart by colour-blind readers, and shapes
/// and dashes differ too.
struct SeriesStyle {
  std::string colour = "#000000";  ///< as in SVG
  std::string dash{};              ///< stroke-dasharray; empty: solid
  int marker = 0;                  ///< 0..5: disc, square, triangle, diamond, ring, triangle down
  double width = 2;                ///< of the line, px
};

/// The style of curve number `n`; repeats after ten.
SeriesStyle seriesStyle(std::size_t n);

/// A curve, or marks, or both.
struct PlotSeries {
  std::string label{};
  std::vector<double> x{}, y{};  ///< of equal length; where one is not finite the line is broken
  std::vector<std::string> notes{};  ///< text shown over each mark; may be empty
  SeriesStyle style{};
  bool line = true, marks = true;

  /// Appends a point, with text shown over its mark: for all points or for none.
  void add(double at_x, double at_y, std::string note = "");
};

/// Series on common axes, the first on top.
struct Plot {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotSeries> series;
  double width = 480, height = 340;  ///< user units; text is 12 of them
};

/// An <svg> element with nothing that it needs from elsewhere. It scales to the width it is given.
std::string svgOf(const Plot& plot);

/// HTML: a small drawing of line and mark for each series, and its label.
std::string legendOf(const std::vector<PlotSeries>& series);

/// A piece of a drawing, from y = 0 to its height.
struct SvgPart {
  std::string svg{};  ///< elements
  double height = 0;  ///< user units
};

/// The same legend as a piece of a drawing, in as many columns as fit `width`.
SvgPart legendPart(const std::vector<PlotSeries>& series, double width);

/// The marker alone, as SVG, at (x, y).
std::string markerAt(double x, double y, const SeriesStyle& style, double size);

/// Round numbers within [lowest, highest], about `count` of them: multiples of 1, 2 or 5 times a
/// power of ten.
std::vector<double> linearTicks(double lowest, double highest, int count = 5);

/// The same for a logarithmic axis: powers of ten; between them 2 and 5, then all digits, where
/// there would be fewer than three; where not two of these are within, linearTicks.
std::vector<double> logarithmicTicks(double lowest, double highest);

/// "0.02", "300", "10⁻⁵": a tick in the fewest characters.
std::string tickLabel(double value);

}  // namespace palpate
