#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "viewer/plot/svg_plot.hpp"

namespace palpate {

/// Colours of viridis for positive numbers, logarithmic, from dark blue (small) to yellow (large).
class ColourScale {
 public:
  /// Limits are powers of ten around all but the outermost 2 % of the positive, finite values, at
  /// most five decades, the upper ones kept; 1e-3 to 1 when there are none.
  explicit ColourScale(const std::vector<double>& values);

  double lowest() const { return lowest_; }
  double highest() const { return highest_; }
  static constexpr int levels = 25;
  int levelOf(double value) const;       ///< 0..levels-1; beyond the limits the nearest
  static std::string colour(int level);  ///< "#440154"
  std::string colourOf(double value) const { return colour(levelOf(value)); }

 private:
  double lowest_ = 1e-3, highest_ = 1;
};

/// What the numbers of a scale count.
enum class ColourUnit : std::uint8_t { newtons, share };

/// The colours with their numbers, as a piece of a drawing.
SvgPart colourBar(const ColourScale& scale, ColourUnit unit);
inline constexpr double colour_bar_width = 350;  ///< user units

/// The same as an <svg> element, for a key.
std::string colourBarHtml(const ColourScale& scale, ColourUnit unit);

}  // namespace palpate
