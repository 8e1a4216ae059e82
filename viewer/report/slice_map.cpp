#include "viewer/report/slice_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "viewer/plot/svg_plot.hpp"
#include "viewer/plot/viridis.hpp"
#include "viewer/report/error_measures.hpp"
#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

constexpr double margin = 32,
                 step = 3;  ///< user units; whole, so that runs of samples meet without seams
constexpr double edge = step * SliceMap::side, picture = edge + 2 * margin;
constexpr int most_decades = 5;
constexpr double beyond =
    0.02;  ///< share of the values that may lie beyond either end of the colours

/// Index of a sample of a SliceMap.
std::size_t sampleAt(int row, int column) {
  return static_cast<std::size_t>(row) * SliceMap::side + static_cast<std::size_t>(column);
}

/// Metres to user units.
double place(double metres, double radius) { return margin + edge * 0.5 * (1 + metres / radius); }

/// One path per colour, of runs of samples along the rows: small, and no seams between neighbours.
std::string colours(const SliceMap& map, const ColourScale& scale) {
  std::array<std::string, ColourScale::levels> paths;
  for (int row = 0; row < SliceMap::side; ++row) {
    const auto level = [&](int column) {
      const double value = map.bound[sampleAt(row, column)];
      return std::isfinite(value) ? scale.levelOf(value) : -1;
    };
    for (int begin = 0, end = 0; begin < SliceMap::side; begin = end) {
      const int run = level(begin);
      while (end < SliceMap::side && level(end) == run) ++end;
      if (run >= 0)
        paths[static_cast<std::size_t>(run)] += fmt::format(
            "M{:g} {:g}h{:g}v{:g}h{:g}z", margin + begin * step,
            picture - margin - (row + 1) * step, (end - begin) * step, step, (begin - end) * step);
    }
  }
  std::string svg = "<g shape-rendering=\"crispEdges\">";
  for (int level = 0; level < ColourScale::levels; ++level)
    if (const std::string& path = paths[static_cast<std::size_t>(level)]; !path.empty())
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

std::string frame(const SliceMap& map) {
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  const double center = 0.5 * picture, base = picture - margin + 4, start = margin - 4;
  std::string svg =
      fmt::format("<circle class=\"rim\" cx=\"{0}\" cy=\"{0}\" r=\"{1}\"/>\n", center, 0.5 * edge);
  svg += fmt::format("<path class=\"axis\" d=\"M{0} {1}h{2}M{3} {0}v{2}\"/>\n", margin, base, edge,
                     start);
  const std::array<std::string, 3> numbers = {
      fmt::format("{:g}", -std::round(1e4 * map.radius) / 10), "",
      fmt::format("{:g}", std::round(1e4 * map.radius) / 10)};
  for (int n = 0; n < 3; ++n) {
    const double along = margin + 0.5 * edge * n;
    const auto which = static_cast<std::size_t>(n);
    const std::string across =
        n == 1 ? names[static_cast<std::size_t>(map.across)] : numbers[which];
    const std::string up = n == 1 ? names[static_cast<std::size_t>(map.up)] : numbers[which];
    svg += fmt::format("<path class=\"axis\" d=\"M{:.1f} {}v4M{} {:.1f}h-4\"/>", along, base, start,
                       picture - along);
    svg +=
        fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                    along, base + 16, across);
    svg += fmt::format("<text class=\"tick\" x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{}</text>\n",
                       start - 6, picture - along + 4, up);
  }
  return svg;
}

/// The sides between samples that are covered and samples of the ball that are not.
std::string coverEdge(const SliceMap& map) {
  const auto covered = [&](int row, int column) { return map.covered[sampleAt(row, column)] != 0; };
  std::string path;
  for (int row = 1; row < SliceMap::side; ++row)
    for (int column = 1; column < SliceMap::side; ++column) {
      const double x = margin + column * step, y = picture - margin - row * step;
      if (covered(row, column) != covered(row - 1, column))
        path += fmt::format("M{:.1f} {:.1f}h{:.1f}", x, y, step);
      if (covered(row, column) != covered(row, column - 1))
        path += fmt::format("M{:.1f} {:.1f}v-{:.1f}", x, y, step);
    }
  return path.empty() ? "" : fmt::format("<path class=\"cover\" d=\"{}\"/>\n", path);
}

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

SliceMap sampleSlice(const ForceField& field, const SpaceTable& space, int across, int up,
                     const std::vector<MeasuredReference>& references, double thickness) {
  SliceMap map;
  map.across = across;
  map.up = up;
  map.radius = space.lattice.radius();
  const int normal = 3 - across - up;
  for (int row = 0; row < SliceMap::side; ++row)
    for (int column = 0; column < SliceMap::side; ++column) {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      p[across] = map.radius * (2 * (column + 0.5) / SliceMap::side - 1);
      p[up] = map.radius * (2 * (row + 0.5) / SliceMap::side - 1);
      const ForceSample sample = field.evaluate(p);
      const bool shown = p.norm() <= map.radius && sample.inside;
      map.bound.push_back(shown ? sample.error_bound : std::nan(""));
      map.covered.push_back(p.norm() <= map.radius && isCovered(sample) ? 1 : 0);
    }
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.point(n)[static_cast<std::size_t>(normal)] == 0) {
      const Eigen::Vector3d p = space.lattice.displacement(n);
      if (p.norm() <= map.radius * (1 + 1e-9))
        map.marks.push_back({{p[across], p[up]}, space.points[n].tag});
    }
  const auto is_in_plane = [&](std::int32_t n) {
    return space.lattice.point(n)[static_cast<std::size_t>(normal)] == 0;
  };
  for (const LatticeEdge& jump : space.inconsistent_edges) {
    if (!is_in_plane(jump.a) || !is_in_plane(jump.b)) continue;
    const Eigen::Vector3d a = space.lattice.displacement(jump.a),
                          b = space.lattice.displacement(jump.b);
    map.jumps.push_back({Eigen::Vector2d(a[across], a[up]), Eigen::Vector2d(b[across], b[up])});
  }
  for (const MeasuredReference& reference : references)
    if (std::abs(reference.displacement[normal]) < thickness) map.references.push_back(reference);
  return map;
}

std::string svgOf(const SliceMap& map, const ColourScale& scale) {
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {0} {0}\" role=\"img\" aria-label=\"error in a slice\">\n", picture);
  if (!map.bound.empty()) svg += colours(map, scale) + coverEdge(map);
  svg += frame(map);
  const auto x = [&](double metres) { return place(metres, map.radius); };
  const auto y = [&](double metres) { return picture - place(metres, map.radius); };
  for (const auto& [a, b] : map.jumps)
    svg += fmt::format("<path class=\"jump\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x(a.x()),
                       y(a.y()), x(b.x()), y(b.y()));
  for (const SliceMap::LatticeMark& mark : map.marks)
    svg += latticeMark(x(mark.at.x()), y(mark.at.y()), mark.tag) + '\n';
  for (const MeasuredReference& reference : map.references)
    svg += fmt::format(
        "<circle class=\"probe\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\"><title>{:.2g} "
        "N</title></circle>\n",
        x(reference.displacement[map.across]), y(reference.displacement[map.up]),
        scale.colourOf(reference.error), reference.error);
  return svg + "</svg>\n";
}

std::string legendOf(const ColourScale& scale) {
  constexpr double width = 12;
  std::string svg = fmt::format(
      "<svg class=\"colours\" viewBox=\"0 0 {0} 34\" width=\"{0}\" height=\"34\" role=\"img\" "
      "aria-label=\"colours\">",
      ColourScale::levels * width + 40);
  for (int level = 0; level < ColourScale::levels; ++level)
    svg += fmt::format("<path d=\"M{} 2h{}v14h-{}z\" fill=\"{}\"/>", 20 + level * width,
                       width + 0.3, width + 0.3, ColourScale::colour(level));
  const double decades = std::log10(scale.highest() / scale.lowest());
  for (int n = 0; n <= static_cast<int>(std::lround(decades)); ++n)
    svg +=
        fmt::format("<text class=\"tick\" x=\"{:.1f}\" y=\"30\" text-anchor=\"middle\">{}{}</text>",
                    20 + ColourScale::levels * width * n / decades,
                    tickLabel(scale.lowest() * std::pow(10, n)), n == 0 ? " N" : "");
  svg += "</svg>";
  const auto key = [](const std::string& mark, const char* text) {
    return fmt::format(
        "<span><svg viewBox=\"0 0 14 14\" width=\"14\" height=\"14\" "
        "aria-hidden=\"true\">{}</svg> {}</span> ",
        mark, text);
  };
  return "<p class=\"legend\"><span>" + svg + "</span> " +
         key(latticeMark(7, 7, Tag::expandable), "lattice point") +
         key(latticeMark(7, 7, Tag::terminating), "terminating (force limit)") +
         key(latticeMark(7, 7, Tag::failed), "failed") +
         key(fmt::format("<circle class=\"probe\" cx=\"7\" cy=\"7\" r=\"4\" fill=\"{}\"/>",
                         ColourScale::colour(12)),
             "exact solution near the plane, in the colour of the error there") +
         key("<path class=\"cover\" d=\"M0 7h14\"/>",
             "inside: eight solved corners on one branch") +
         key("<path class=\"jump\" d=\"M1 7h12\"/>", "jump between branches") + "</p>\n";
}

}  // namespace palpate
