#include "viewer/report/colour_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "viewer/plot/viridis.hpp"
#include "viewer/report/error_measures.hpp"

namespace palpate {
namespace {

constexpr int most_decades = 5;
constexpr double beyond = 0.02;  ///< share of the values that may lie beyond either limit

}  // namespace

ColourScale::ColourScale(const std::vector<double>& values) {
  std::vector<double> positive;
  std::copy_if(values.begin(), values.end(), std::back_inserter(positive),
               [](double value) { return std::isfinite(value) && value > 0; });
  if (positive.empty()) return;
  std::sort(positive.begin(), positive.end());
  const double top = std::ceil(std::log10(percentile(positive, 1 - beyond)) - 1e-9);
  const double base = std::floor(std::log10(percentile(positive, beyond)) + 1e-9);
  lowest_ = std::pow(10, std::clamp(base, top - most_decades, top - 1));
  highest_ = std::pow(10, top);
}

int ColourScale::levelOf(double value) const {
  if (!(value > lowest_)) return 0;
  const double share = std::log(value / lowest_) / std::log(highest_ / lowest_);
  return std::clamp(static_cast<int>(share * levels), 0, levels - 1);
}

std::string ColourScale::colour(int level) {
  const std::array<double, 3> rgb = viridis(static_cast<double>(level) / (levels - 1));
  return fmt::format("#{:02x}{:02x}{:02x}", std::lround(rgb[0]), std::lround(rgb[1]),
                     std::lround(rgb[2]));
}

}  // namespace palpate
