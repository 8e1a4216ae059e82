#pragma once

namespace palpate {

/// Wendland's compactly supported function (1 - x)^4 (4 x + 1) on 0 <= x <= 1, twice continuously
/// differentiable in three dimensions (Wendland 1995). slope_over_x is its derivative divided by x,
/// finite at 0.
struct Wendland {
  explicit Wendland(double x) noexcept {
    const double u = 1 - x, cubed = u * u * u;
    value = cubed * u * (4 * x + 1);
    slope_over_x = -20 * cubed;
  }
  double value, slope_over_x;
};

}  // namespace palpate
