#include "viewer/report/colour_scale.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "viewer/plot/viridis.hpp"
#include "viewer/report/error_measures.hpp"

namespace palpate {
namespace {

constexpr int most_decades = 5;
constexpr double beyond = 0.02;  ///< share of the values that may lie beyond either limit

}  // namespace

ColourScale::ColourScale(const std::vector<double>& values) {
  std::vector<double> positive;
  std::ranges::copy_if(values, std::back_inserter(positive),
                       [](double value) { return std::isfinite(value) && value > 0; });
  if (positive.empty()) return;
  std::ranges::sort(positive);
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

SvgPart colourBar(const ColourScale& scale, ColourUnit unit) {
  constexpr double margin = 24, box = (colour_bar_width - 2 * margin) / ColourScale::levels;
  SvgPart part = {.height = 40};
  for (int level = 0; level < ColourScale::levels; ++level)
    part.svg += fmt::format("<path d=\"M{:.1f} 2h{:.1f}v14h-{:.1f}z\" fill=\"{}\"/>",
                            margin + level * box, box + 0.3, box + 0.3, ColourScale::colour(level));
  const auto decades = static_cast<int>(std::lround(std::log10(scale.highest() / scale.lowest())));
  for (int n = 0; n <= decades; ++n) {
    const double value = scale.lowest() * std::pow(10, n);
    const std::string label =
        unit == ColourUnit::share ? fmt::format("{:.4g} %", 100 * value) : tickLabel(value) + " N";
    part.svg +=
        fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"31\" text-anchor=\"middle\">{}</text>",
                    margin + ColourScale::levels * box * n / decades, label);
  }
  return part;
}

std::string colourBarHtml(const ColourScale& scale, ColourUnit unit) {
  const SvgPart bar = colourBar(scale, unit);
  return fmt::format(
      "<svg class=\"colours\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "role=\"img\" aria-label=\"colours\">{2}</svg>",
      colour_bar_width, bar.height, bar.svg);
}

}  // namespace palpate
