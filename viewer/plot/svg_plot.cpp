#include "viewer/plot/svg_plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"
#include "viewer/plot/round_numbers.hpp"

namespace palpate {
namespace {

constexpr double left_margin = 62, right_margin = 14, top_margin = 30, bottom_margin = 46;
constexpr double padding = 0.04;  // of the range, beyond the data
constexpr double mark_size = 4.2;

/// Where values lie on the page.
class Scale {
 public:
  Scale(const PlotAxis& axis, double lowest, double highest, double from, double to)
      : logarithmic_(axis.logarithmic), lowest_(lowest), highest_(highest), from_(from), to_(to) {}

  double operator()(double value) const {
    return from_ +
           (to_ - from_) * (inner(value) - inner(lowest_)) / (inner(highest_) - inner(lowest_));
  }
  bool shows(double value) const { return std::isfinite(value) && (!logarithmic_ || value > 0); }
  std::vector<double> ticks() const {
    // Labels of five digits do not touch.
    const int count = std::max(5, static_cast<int>(std::abs(to_ - from_) / 60));
    return logarithmic_ ? logarithmicTicks(lowest_, highest_)
                        : linearTicks(lowest_, highest_, count);
  }

 private:
  double inner(double value) const { return logarithmic_ ? std::log10(value) : value; }
  bool logarithmic_;
  double lowest_, highest_, from_, to_;
};

Scale scaleOf(const Plot& plot, const PlotAxis& axis, std::vector<double> PlotSeries::*values,
              double from, double to) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (const PlotSeries& series : plot.series)
    for (const double value : series.*values) {
      if (!std::isfinite(value) || (axis.logarithmic && value <= 0)) continue;
      lowest = std::min(lowest, value);
      highest = std::max(highest, value);
    }
  // An empty plot has axes all the same.
  if (lowest > highest) lowest = 1, highest = 10;
  if (axis.logarithmic) {
    const double pad =
        std::max(padding * std::log10(highest / lowest), highest == lowest ? 0.5 : 0.0);
    lowest *= std::pow(10, -pad);
    highest *= std::pow(10, pad);
  } else {
    const double pad =
        highest > lowest ? padding * (highest - lowest) : std::max(0.5 * std::abs(highest), 0.5);
    lowest -= pad;
    highest += pad;
  }
  return {axis, lowest, highest, from, to};
}

std::string frame(const Plot& plot, const Scale& x, const Scale& y) {
  const double base = plot.height - bottom_margin, end = plot.width - right_margin;
  std::string svg;
  for (const double tick : x.ticks())
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\"/><text "
        "class=\"tick\" x=\"{0:.1f}\" y=\"{3}\" text-anchor=\"middle\">{4}</text>\n",
        x(tick), top_margin, base, base + 16, tickLabel(tick));
  for (const double tick : y.ticks())
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{0}\" y1=\"{1:.1f}\" x2=\"{2}\" y2=\"{1:.1f}\"/><text "
        "class=\"tick\" x=\"{3}\" y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
        left_margin, y(tick), end, left_margin - 6, y(tick) + 4, tickLabel(tick));
  svg += fmt::format("<path class=\"axis\" d=\"M{} {}V{}H{}\"/>\n", left_margin, top_margin, base,
                     end);
  return svg + fmt::format(
                   "<text class=\"title\" x=\"{}\" y=\"18\">{}</text>\n"
                   "<text class=\"label\" x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n"
                   "<text class=\"label\" transform=\"translate(15 {:.1f}) "
                   "rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
                   left_margin, escaped(plot.title), 0.5 * (left_margin + end), plot.height - 8,
                   escaped(plot.x.label), 0.5 * (top_margin + base), escaped(plot.y.label));
}

std::string lineOf(const PlotSeries& series, const Scale& x, const Scale& y) {
  std::string path;
  bool broken = true;
  for (std::size_t n = 0; n < series.x.size(); ++n) {
    const bool shown = x.shows(series.x[n]) && y.shows(series.y[n]);
    if (shown)
      path += fmt::format("{}{:.1f} {:.1f}", broken ? 'M' : 'L', x(series.x[n]), y(series.y[n]));
    broken = !shown;
  }
  if (path.empty()) return "";
  const std::string dash =
      series.style.dash.empty() ? "" : fmt::format(" stroke-dasharray=\"{}\"", series.style.dash);
  return fmt::format("<path class=\"curve\" d=\"{}\" stroke=\"{}\" stroke-width=\"{}\"{}/>\n", path,
                     series.style.colour, series.style.width, dash);
}

std::string marksOf(const PlotSeries& series, const Scale& x, const Scale& y) {
  std::string svg;
  for (std::size_t n = 0; n < series.x.size(); ++n) {
    if (!x.shows(series.x[n]) || !y.shows(series.y[n])) continue;
    const std::string mark = markerAt(x(series.x[n]), y(series.y[n]), series.style, mark_size);
    svg += n < series.notes.size()
               ? fmt::format("<g><title>{}</title>{}</g>\n", escaped(series.notes[n]), mark)
               : mark + '\n';
  }
  return svg;
}

/// Line and mark of a series in a box of 34 x 12.
std::string seriesKey(const PlotSeries& series) {
  std::string svg;
  if (series.line)
    svg += fmt::format(
        "<path d=\"M1 6H33\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" "
        "stroke-dasharray=\"{}\"/>",
        series.style.colour, series.style.width,
        series.style.dash.empty() ? "none" : series.style.dash);
  if (series.marks) svg += markerAt(17, 6, series.style, mark_size);
  return svg;
}

}  // namespace

void PlotSeries::add(double at_x, double at_y, std::string note) {
  x.push_back(at_x);
  y.push_back(at_y);
  if (!note.empty()) notes.push_back(std::move(note));
}

SeriesStyle seriesStyle(std::size_t n) {
  // Okabe and Ito's palette without its yellow, which is too light on white; two more at the end.
  static const std::array<const char*, 10> colours = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                                      "#e69f00", "#56b4e9", "#000000", "#7a5195",
                                                      "#8c6d31", "#7f7f7f"};
  static const std::array<const char*, 10> dashes = {"",    "",    "",    "",    "",
                                                     "6 3", "6 3", "2 3", "2 3", "6 3"};
  n %= colours.size();
  return {colours[n], dashes[n], static_cast<int>(n % 6), n == 0 ? 2.6 : 1.7};
}

std::string markerAt(double x, double y, const SeriesStyle& style, double size) {
  /// From a corner relative to (x, y) along relative steps, all in sizes; closed.
  const auto polygon = [&](double corner_x, double corner_y, const char* path, auto... steps) {
    return fmt::format("<path d=\"M{:.1f} {:.1f}{}z\" fill=\"{}\"/>", x + corner_x * size,
                       y + corner_y * size, fmt::format(fmt::runtime(path), steps * size...),
                       style.colour);
  };
  switch (style.marker) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"{}\"/>", x, y,
                         size, style.colour);
    case 1: return polygon(-0.9, -0.9, "h{:.1f}v{:.1f}h{:.1f}", 1.8, 1.8, -1.8);
    case 2: return polygon(0, -1.2, "l{:.1f} {:.1f}h{:.1f}", 1.1, 2.0, -2.2);
    case 3:
      return polygon(0, -1.3, "l{:.1f} {:.1f}l{:.1f} {:.1f}l{:.1f} {:.1f}", 1.3, 1.3, -1.3, 1.3,
                     -1.3, -1.3);
    case 4:
      return fmt::format(
          "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" fill=\"#fff\" stroke=\"{}\" "
          "stroke-width=\"2\"/>",
          x, y, 0.85 * size, style.colour);
    default: return polygon(0, 1.2, "l{:.1f} {:.1f}h{:.1f}", 1.1, -2.0, -2.2);
  }
}

std::string svgOf(const Plot& plot) {
  const Scale x = scaleOf(plot, plot.x, &PlotSeries::x, left_margin, plot.width - right_margin);
  const Scale y = scaleOf(plot, plot.y, &PlotSeries::y, plot.height - bottom_margin, top_margin);
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">\n",
                                plot.width, plot.height, escaped(plot.title));
  svg += frame(plot, x, y);
  // What is drawn last is on top.
  for (std::size_t n = plot.series.size(); n-- > 0;) {
    PALPATE_ASSERT(plot.series[n].x.size() == plot.series[n].y.size(),
                   "a mark has a place on both axes");
    if (plot.series[n].line) svg += lineOf(plot.series[n], x, y);
    if (plot.series[n].marks) svg += marksOf(plot.series[n], x, y);
  }
  return svg + "</svg>\n";
}

std::string legendOf(const std::vector<PlotSeries>& series) {
  std::string html = "<p class=\"legend\">";
  for (const PlotSeries& one : series)
    html += fmt::format(
        "<span><svg viewBox=\"0 0 34 12\" width=\"34\" height=\"12\" "
        "aria-hidden=\"true\">{}</svg> {}</span> ",
        seriesKey(one), escaped(one.label));
  return html + "</p>\n";
}

SvgPart legendPart(const std::vector<PlotSeries>& series, double width) {
  constexpr double line_height = 20, key_width = 42, letter_width = 6.6;
  std::size_t longest = 0;
  for (const PlotSeries& one : series) longest = std::max(longest, one.label.size());
  const double column = key_width + letter_width * static_cast<double>(longest) + 14;
  const auto columns =
      static_cast<std::size_t>(std::max(1.0, std::floor((width - left_margin) / column)));
  SvgPart part;
  for (std::size_t n = 0; n < series.size(); ++n) {
    const std::size_t line = n / columns;
    part.svg += fmt::format(
        "<g transform=\"translate({:g} {:g})\">{}<text class=\"label\" x=\"{}\" "
        "y=\"10\">{}</text></g>\n",
        left_margin + column * static_cast<double>(n % columns),
        line_height * static_cast<double>(line) + 4, seriesKey(series[n]), key_width,
        escaped(series[n].label));
    part.height = line_height * static_cast<double>(line + 1) + 8;
  }
  return part;
}

std::vector<double> linearTicks(double lowest, double highest, int count) {
  const double rough = (highest - lowest) / std::max(count, 1);
  if (!(rough > 0) || !std::isfinite(rough)) return {lowest};
  const double step = roundUp(rough);
  std::vector<double> ticks;
  for (double n = std::ceil(lowest / step - 1e-9); n * step <= highest + 1e-9 * step; ++n)
    // Not "-0".
    ticks.push_back(n == 0 ? 0 : n * step);
  return ticks;
}

std::vector<double> logarithmicTicks(double lowest, double highest) {
  if (!(lowest > 0) || !(highest > lowest) || !std::isfinite(highest)) return {lowest};
  static const std::array<std::vector<int>, 3> digits = {
      {{1}, {1, 2, 5}, {1, 2, 3, 4, 5, 6, 7, 8, 9}}};
  const int first = static_cast<int>(std::floor(std::log10(lowest)));
  const int last = static_cast<int>(std::ceil(std::log10(highest)));
  // More labels than eight would touch each other.
  const int every = std::max(1, (last - first + 7) / 8);  // decades
  std::vector<double> ticks;
  for (const std::vector<int>& leading : digits) {
    ticks.clear();
    for (int decade = first; decade <= last; ++decade)
      for (const int digit : leading) {
        const double value = digit * std::pow(10, decade);
        if (decade % every == 0 && value >= lowest * (1 - 1e-9) && value <= highest * (1 + 1e-9))
          ticks.push_back(value);
      }
    // Two numbers do not show that an axis is logarithmic.
    if (ticks.size() >= 3) break;
  }
  // Between two leading digits an axis would have no number, or one.
  return ticks.size() < 2 ? linearTicks(lowest, highest) : ticks;
}

std::string tickLabel(double value) {
  const double magnitude = std::abs(value);
  if (value == 0 || (magnitude >= 9.99e-4 && magnitude < 99999))
    return fmt::format("{:.6g}", value);
  static const std::array<const char*, 10> raised = {"⁰", "¹", "²", "³", "⁴",
                                                     "⁵", "⁶", "⁷", "⁸", "⁹"};
  const int exponent = static_cast<int>(std::floor(std::log10(magnitude) + 1e-9));
  const double leading = value / std::pow(10, exponent);
  std::string label = std::abs(leading - 1) < 1e-6 ? "10" : fmt::format("{:.3g}·10", leading);
  if (exponent < 0) label += "⁻";
  for (const char digit : std::to_string(std::abs(exponent))) label += raised[digit - '0'];
  return label;
}

}  // namespace palpate
