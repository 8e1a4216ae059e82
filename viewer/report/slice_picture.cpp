#include "viewer/report/slice_picture.hpp"

#include <fmt/format.h>

#include <cmath>

#include "common/base/assertion.hpp"
#include "viewer/plot/csv.hpp"
#include "viewer/report/error_measures.hpp"

namespace palpate {
namespace {

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

/// A mark in a box of 14 x 14, and what it means.
struct SliceKey {
  std::string mark;
  const char* text;
};
std::vector<SliceKey> sliceKeys() {
  return {{latticeMark(7, 7, Tag::expandable), "lattice point"},
          {latticeMark(7, 7, Tag::terminating), "terminating (force limit)"},
          {latticeMark(7, 7, Tag::failed), "failed"},
          {fmt::format("<circle class=\"probe\" cx=\"7\" cy=\"7\" r=\"4\" fill=\"{}\"/>",
                       ColourScale::colour(12)),
           "exact solution near the plane, coloured by its error"},
          {"<path class=\"cover\" d=\"M0 7h14\"/>", "inside: eight solved corners on one branch"},
          {"<path class=\"jump\" d=\"M1 7h12\"/>", "jump between branches"}};
}

/// The key below a map that is a file of its own.
SvgPart sliceKeyPart(const ColourScale& scale) {
  SvgPart part = colourBar(scale, ColourUnit::newtons);
  for (const SliceKey& key : sliceKeys()) {
    // White on white would not be seen.
    part.svg += fmt::format(
        "<g transform=\"translate(8 {:g})\"><rect width=\"14\" height=\"14\" fill=\"#dde1e5\"/>"
        "{}<text class=\"tick\" x=\"22\" y=\"11\">{}</text></g>\n",
        part.height, key.mark, key.text);
    part.height += 19;
  }
  return part;
}

/// Of rows from the lowest to the highest; the first line and the first column are places, mm.
std::string boundsCsv(const SliceMap& map) {
  const auto place = [&](int n) {
    return csvNumber(1e3 * map.radius * (2 * (n + 0.5) / SliceMap::side - 1), 5);
  };
  std::vector<std::string> cells = {fmt::format("{} (mm) down / {} (mm) across: error bound (N)",
                                                axis_names[map.up], axis_names[map.across])};
  for (int column = 0; column < SliceMap::side; ++column) cells.push_back(place(column));
  std::string text = csvLine(cells);
  for (int row = 0; row < SliceMap::side; ++row) {
    cells = {place(row)};
    for (int column = 0; column < SliceMap::side; ++column)
      cells.push_back(csvNumber(map.bound[SliceMap::sampleAt(row, column)], 3));
    text += csvLine(cells);
  }
  return text;
}

std::string marksCsv(const SliceMap& map) {
  const auto line = [](std::string_view what, const Eigen::Vector2d& at, double error) {
    return csvLine({std::string(what), csvNumber(1e3 * at.x(), 6), csvNumber(1e3 * at.y(), 6),
                    csvNumber(error, 6)});
  };
  std::string text = csvLine({"mark", fmt::format("{} (mm)", axis_names[map.across]),
                              fmt::format("{} (mm)", axis_names[map.up]), "error (N)"});
  for (const SliceMap::LatticeMark& mark : map.marks)
    text += line(name(mark.tag), mark.at, not_measured);
  for (const SliceMap::ErrorMark& mark : map.errors)
    text += line("exact solution", mark.at, mark.error);
  return text;
}

}  // namespace

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

Panel panelOf(const SliceMap& map, const ColourScale& scale, const std::string& caption) {
  return {.svg = svgOf(map, scale),
          .caption = caption,
          .key = sliceKeyPart(scale),
          .data = {{"CSV", ".csv", boundsCsv(map)}, {"CSV of marks", "-marks.csv", marksCsv(map)}}};
}

std::string legendOf(const ColourScale& scale) {
  std::string html =
      "<p class=\"legend\"><span>" + colourBarHtml(scale, ColourUnit::newtons) + "</span> ";
  for (const SliceKey& key : sliceKeys())
    html += fmt::format(
        "<span><svg viewBox=\"0 0 14 14\" width=\"14\" height=\"14\" "
        "aria-hidden=\"true\">{}</svg> {}</span> ",
        key.mark, key.text);
  return html + "</p>\n";
}

}  // namespace palpate
