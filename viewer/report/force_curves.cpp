#include "viewer/report/force_curves.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/number_text.hpp"

namespace palpate {
namespace {

constexpr double curve_width = 380, curve_height = 290;  // user units
constexpr const char* exact_colour = "#1b1f24";
constexpr const char* held_out_colour = "#b00020";

}  // namespace

void addForces(const AxisForces& along, PlotSeries& series) {
  PALPATE_ASSERT(along.displacements.size() == along.forces.size(), "a force has its place");
  for (std::size_t n = 0; n < along.forces.size(); ++n)
    series.add(1e3 * along.displacements[n], along.forces[n]);
}

std::vector<PlotSeries> curveSeries(std::vector<PlotSeries> interpolations, ExactMarks marks) {
  std::vector<PlotSeries> series;
  if (marks != ExactMarks::solved)
    series.push_back({.label = "exact, not seen",
                      .style = {.colour = held_out_colour, .marker = 3},
                      .line = false});
  if (marks != ExactMarks::held_out)
    series.push_back({.label = "exact, solved", .style = {.colour = exact_colour}, .line = false});
  for (PlotSeries& curve : interpolations) {
    curve.marks = false;
    series.push_back(std::move(curve));
  }
  return series;
}

Plot forcePlot(const ForceWay& way, const std::vector<PlotSeries>& interpolations,
               const std::string& title, const std::string& along) {
  PALPATE_ASSERT(way.sampled.size() == interpolations.size(), "a curve for each interpolation");
  const bool has_held_out = !way.held_out.forces.empty(), has_solved = !way.solved.forces.empty();
  const ExactMarks marks = has_held_out && has_solved ? ExactMarks::both
                           : has_held_out             ? ExactMarks::held_out
                                                      : ExactMarks::solved;
  Plot plot = {.title = title,
               .x = {fmt::format("displacement {}, mm", along)},
               .y = {fmt::format("force {}, N", along)},
               .series = curveSeries(interpolations, marks),
               .width = curve_width,
               .height = curve_height};
  if (has_held_out) addForces(way.held_out, plot.series.front());
  const std::size_t first = plot.series.size() - interpolations.size();
  if (has_solved) addForces(way.solved, plot.series[first - 1]);
  for (std::size_t m = 0; m < way.sampled.size(); ++m)
    addForces(way.sampled[m], plot.series[first + m]);
  // The default, the widest line, below the others.
  std::reverse(plot.series.begin() + static_cast<std::ptrdiff_t>(first), plot.series.end());
  return plot;
}

std::string describeDirection(const Eigen::Vector3d& direction) {
  const Eigen::Vector3d rounded = (100 * direction).array().round() / 100;
  return fmt::format("direction ({})", vectorText(rounded, 2));
}

}  // namespace palpate
