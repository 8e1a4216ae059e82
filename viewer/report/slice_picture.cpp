#include "viewer/report/slice_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "viewer/plot/svg_plot.hpp"
#include "viewer/plot/viridis.hpp"
#include "viewer/report/error_measures.hpp"

namespace palpate {
namespace {

constexpr int most_decades = 5;
constexpr double beyond = 0.02;  ///< share of the values that may lie beyond either limit

// User units. `step` is whole, so that runs of samples meet without seams; the left margin holds
// numbers like "-123.4".
constexpr double step = 3, edge = step * SliceMap::side;
constexpr double left = 56, right = 24, top = 12, bottom = 28, base = top + edge;
constexpr std::array<const char*, 3> axis_names = {"x", "y", "z"};

/// One path per colour, of runs of samples along the rows: small, and no seams between neighbours.
std::string colours(const SliceMap& map, const ColourScale& scale) {
  std::array<std::string, ColourScale::levels> paths;
  for (int row = 0; row < SliceMap::side; ++row) {
    const auto level = [&](int column) {
      const double value = map.bound[SliceMap::sampleAt(row, column)];
      return std::isfinite(value) ? scale.levelOf(value) : -1;
    };
    for (int begin = 0, end = 0; begin < SliceMap::side; begin = end) {
      const int run = level(begin);
      while (end < SliceMap::side && level(end) == run) ++end;
      if (run >= 0)
        paths[run] +=
            fmt::format("M{:g} {:g}h{:g}v{:g}h{:g}z", left + begin * step, base - (row + 1) * step,
                        (end - begin) * step, step, (begin - end) * step);
    }
  }
  std::string svg = "<g shape-rendering=\"crispEdges\">";
  for (int level = 0; level < ColourScale::levels; ++level)
    if (const std::string& path = paths[level]; !path.empty())
      svg += fmt::format("<path d=\"{}\" fill=\"{}\"/>\n", path, ColourScale::colour(level));
  return svg + "</g>\n";
}

std::string latticeMark(double x, double y, Tag tag) {
  switch (tag) {
    case Tag::expandable:
      return fmt::format("<circle class=\"solved\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"1.7\"/>", x, y);
    case Tag::terminating:
      return fmt::format("<path class=\"terminating\" d=\"M{:.1f} {:.1f}l4 4l-4 4l-4 -4z\"/>", x,
                         y - 4);
    default:
      return fmt::format("<path class=\"failed\" d=\"M{:.1f} {:.1f}l7 7m0 -7l-7 7\"/>", x - 3.5,
                         y - 3.5);
  }
}

/// The rim of the ball, and two axes with -radius, the name, and radius.
std::string frame(const SliceMap& map) {
  const double axis_x = left - 4, axis_y = base + 4, radius = std::round(1e4 * map.radius) / 10;
  const auto label = [&](int n, int axis) {
    return n == 0 ? axis_names[axis] : fmt::format("{:g}", n * radius);
  };
  std::string svg = fmt::format(
      "<circle class=\"rim\" cx=\"{}\" cy=\"{}\" r=\"{}\"/>\n"
      "<path class=\"axis\" d=\"M{} {}h{}M{} {}v{}\"/>\n",
      left + edge / 2, top + edge / 2, edge / 2, left, axis_y, edge, axis_x, top, edge);
  for (const int n : {-1, 0, 1}) {
    const double x = left + edge * (n + 1) / 2, y = base - edge * (n + 1) / 2;
    svg += fmt::format(
        "<path class=\"axis\" d=\"M{0:.1f} {1}v4M{2} {3:.1f}h-4\"/>"
        "<text class=\"tick\" x=\"{0:.1f}\" y=\"{4}\" text-anchor=\"middle\">{5}</text>"
        "<text class=\"tick\" x=\"{6}\" y=\"{7:.1f}\" text-anchor=\"end\">{8}</text>\n",
        x, axis_y, axis_x, y, axis_y + 16, label(n, map.across), axis_x - 6, y + 4,
        label(n, map.up));
  }
  return svg;
}

/// The sides between samples that are covered and samples of the ball that are not.
std::string coverEdge(const SliceMap& map) {
  const auto covered = [&](int row, int column) {
    return map.covered[SliceMap::sampleAt(row, column)] != 0;
  };
  std::string path;
  for (int row = 1; row < SliceMap::side; ++row)
    for (int column = 1; column < SliceMap::side; ++column) {
      const double x = left + column * step, y = base - row * step;
      if (covered(row, column) != covered(row - 1, column))
        path += fmt::format("M{:.1f} {:.1f}h{:.1f}", x, y, step);
      if (covered(row, column) != covered(row, column - 1))
        path += fmt::format("M{:.1f} {:.1f}v-{:.1f}", x, y, step);
    }
  return path.empty() ? "" : fmt::format("<path class=\"cover\" d=\"{}\"/>\n", path);
}

std::string keyOf(const std::string& mark, const char* text) {
  return fmt::format(
      "<span><svg viewBox=\"0 0 14 14\" width=\"14\" height=\"14\" "
      "aria-hidden=\"true\">{}</svg> {}</span> ",
      mark, text);
}

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

std::string svgOf(const SliceMap& map, const ColourScale& scale) {
  PALPATE_ASSERT(
      map.bound.size() == SliceMap::side * SliceMap::side && map.covered.size() == map.bound.size(),
      "only sampled maps are drawn");
  const auto x = [&](const Eigen::Vector2d& at) {
    return left + 0.5 * edge * (1 + at.x() / map.radius);
  };
  const auto y = [&](const Eigen::Vector2d& at) {
    return base - 0.5 * edge * (1 + at.y() / map.radius);
  };
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"error in a slice\">\n",
                  left + edge + right, base + bottom);
  svg += colours(map, scale) + coverEdge(map) + frame(map);
  for (const auto& [a, b] : map.jumps)
    svg += fmt::format("<path class=\"jump\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x(a), y(a),
                       x(b), y(b));
  for (const SliceMap::LatticeMark& mark : map.marks)
    svg += latticeMark(x(mark.at), y(mark.at), mark.tag) + '\n';
  for (const SliceMap::ErrorMark& mark : map.errors)
    svg += fmt::format(
        "<circle class=\"probe\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\">"
        "<title>{:.2g} N</title></circle>\n",
        x(mark.at), y(mark.at), scale.colourOf(mark.error), mark.error);
  return svg + "</svg>\n";
}

std::string legendOf(const ColourScale& scale) {
  constexpr double box = 12, margin = 20, length = ColourScale::levels * box;
  std::string svg = fmt::format(
      "<svg class=\"colours\" viewBox=\"0 0 {0} 34\" width=\"{0}\" height=\"34\" role=\"img\" "
      "aria-label=\"colours\">",
      length + 2 * margin);
  for (int level = 0; level < ColourScale::levels; ++level)
    svg += fmt::format("<path d=\"M{0} 2h{1}v14h-{1}z\" fill=\"{2}\"/>", margin + level * box,
                       box + 0.3, ColourScale::colour(level));
  const double decades = std::log10(scale.highest() / scale.lowest());
  for (int n = 0; n <= static_cast<int>(std::lround(decades)); ++n)
    svg +=
        fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"30\" text-anchor=\"middle\">{}{}</text>",
                    margin + length * n / decades, tickLabel(scale.lowest() * std::pow(10, n)),
                    n == 0 ? " N" : "");
  return "<p class=\"legend\"><span>" + svg + "</svg></span> " +
         keyOf(latticeMark(7, 7, Tag::expandable), "lattice point") +
         keyOf(latticeMark(7, 7, Tag::terminating), "terminating (force limit)") +
         keyOf(latticeMark(7, 7, Tag::failed), "failed") +
         keyOf(fmt::format("<circle class=\"probe\" cx=\"7\" cy=\"7\" r=\"4\" fill=\"{}\"/>",
                           ColourScale::colour(12)),
               "exact solution near the plane, in the colour of the error there") +
         keyOf("<path class=\"cover\" d=\"M0 7h14\"/>",
               "inside: eight solved corners on one branch") +
         keyOf("<path class=\"jump\" d=\"M1 7h12\"/>", "jump between branches") + "</p>\n";
}

}  // namespace palpate
