#pragma once

#include "viewer/report/node_pictures.hpp"

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

/// The map as an <svg> element, axes in mm.
std::string svgOf(const SliceMap& map, const ColourScale& scale);

/// The colours with their numbers, newtons, and what the marks mean, as HTML.
std::string legendOf(const ColourScale& scale);

}  // namespace palpate
