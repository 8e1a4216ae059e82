#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/index.hpp"
#include "common/mesh/surface_point.hpp"
#include "viewer/plot/widest_view.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"
#include "viewer/report/slice_picture.hpp"

namespace palpate {
namespace {

constexpr double map_width = 520, map_margin = 10;  // user units
constexpr double least_shown = 1e-3;                // what is less has the same colour
constexpr const char* not_answered = "#d9dee3";

/// How a body is looked at: rows are right, up and towards the eye.
struct MapView {
  const char* title;
  Eigen::Matrix3d axes;
};

/// From both sides of the axis along which the body is thinnest, z upwards where that is possible.
std::array<MapView, 2> viewsOf(const Mesh& mesh) {
  const Eigen::Vector3d eye = widestView(mesh.nodes);
  const Eigen::Vector3d up_hint =
      std::abs(eye.z()) < 0.9 ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY();
  const auto axesFrom = [&](const Eigen::Vector3d& towards) {
    Eigen::Matrix3d axes;
    const Eigen::Vector3d right = up_hint.cross(towards).normalized();
    axes << right.transpose(), towards.cross(right).transpose(), towards.transpose();
    return axes;
  };
  return {MapView{"from the front", axesFrom(eye)}, MapView{"from behind", axesFrom(-eye)}};
}

/// The triangles that face the eye, the farthest first, each in its colour; on them the probes.
std::string svgOf(const Mesh& mesh, const AreaMeasures& area, const ColourScale& scale,
                  const MapView& view) {
  const std::vector<double>& values = area.on_triangles;
  std::vector<Eigen::Vector3d> seen;
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity()),
                  high = -low;
  for (const Eigen::Vector3d& node : mesh.nodes) {
    seen.emplace_back(view.axes * node);
    low = low.cwiseMin(seen.back());
    high = high.cwiseMax(seen.back());
  }
  const double unit = (map_width - 2 * map_margin) / (high.x() - low.x());
  const double height = unit * (high.y() - low.y()) + 2 * map_margin;
  const auto depth = [&](std::size_t t) {
    const Triangle& c = mesh.surface[t];
    return seen[at(c[0])].z() + seen[at(c[1])].z() + seen[at(c[2])].z();
  };
  std::vector<std::size_t> order(mesh.surface.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, depth);
  const auto x = [&](const Eigen::Vector3d& p) { return map_margin + unit * (p.x() - low.x()); };
  const auto y = [&](const Eigen::Vector3d& p) { return map_margin + unit * (high.y() - p.y()); };
  std::string svg =
      fmt::format("<svg viewBox=\"0 0 {:.0f} {:.0f}\" role=\"img\">\n", map_width, height);
  for (const std::size_t t : order) {
    const Triangle& c = mesh.surface[t];
    const Eigen::Vector3d &p = seen[at(c[0])], &q = seen[at(c[1])], &r = seen[at(c[2])];
    if ((q - p).cross(r - p).z() <= 0) continue;
    const std::string colour =
        std::isfinite(values[t]) ? scale.colourOf(values[t]) : std::string(not_answered);
    svg += "<path d=\"";
    for (const Eigen::Vector3d* corner : {&p, &q, &r})
      svg += fmt::format("{}{:.1f} {:.1f}", corner == &p ? 'M' : 'L', x(*corner), y(*corner));
    // Stroked alike, so that no seam shows between neighbours.
    svg += fmt::format(
        "z\" fill=\"{0}\" stroke=\"{0}\" stroke-width=\".6\"><title>{1}</title></path>\n", colour,
        formatShare(values[t]));
  }
  for (const AreaProbes::Comparison& probe : area.probes.comparisons) {
    const SurfacePoint at_rest = nearestOnSurface(mesh, probe.place);
    if ((view.axes * normalOf(mesh, at_rest.triangle)).z() <= 0) continue;
    const Eigen::Vector3d place = view.axes * probe.place;
    svg += fmt::format(
        "<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"4\" fill=\"{}\" stroke=\"#fff\">"
        "<title>{} at {:.3g} mm</title></circle>\n",
        x(place), y(place), scale.colourOf(probe.error), formatShare(probe.error),
        1e3 * probe.depth);
  }
  return svg + "</svg>\n";
}

std::string colourKey(const ColourScale& scale) {
  std::string key = "<p class=\"legend\">";
  // Two a decade.
  const auto steps = std::lround(2 * std::log10(scale.highest() / scale.lowest()));
  for (long n = 0; n <= steps; ++n) {
    const double value = scale.lowest() * std::pow(10, 0.5 * static_cast<double>(n));
    key += fmt::format(
        "<span><svg width=\"14\" height=\"14\"><rect width=\"14\" height=\"14\" "
        "fill=\"{}\"/></svg>{}</span>",
        scale.colourOf(value), formatShare(value));
  }
  return key + fmt::format(
                   "<span><svg width=\"14\" height=\"14\"><rect width=\"14\" height=\"14\" "
                   "fill=\"{}\"/></svg>not answered for</span></p>\n",
                   not_answered);
}

std::vector<double> boundsAndErrors(const AreaMeasures& area) {
  std::vector<double> values = area.on_triangles;
  for (const AreaProbes::Comparison& probe : area.probes.comparisons)
    values.push_back(std::max(probe.error, least_shown));
  return values;
}

std::string depthPlot(const AreaMeasures& area) {
  Plot plot = {.title = "Over displacement",
               .x = {"displacement, mm", false},
               .y = {"share of the force", true},
               .series = {{.label = "bound, median", .style = seriesStyle(0)},
                          {.label = "bound, 95 %", .style = seriesStyle(1)}}};
  for (const DepthMeasures& depth : area.depths) {
    plot.series[0].add(1e3 * depth.depth, depth.bound.median);
    plot.series[1].add(1e3 * depth.depth, depth.bound.percentile_95);
  }
  PlotSeries errors = {.label = "error at probes", .style = seriesStyle(2), .line = false};
  for (const AreaProbes::Comparison& probe : area.probes.comparisons)
    errors.add(1e3 * probe.depth, probe.error);
  if (!area.probes.comparisons.empty()) plot.series.push_back(std::move(errors));
  return "<div class=\"single\">" + svgOf(plot) + "</div>\n" + legendOf(plot.series);
}

}  // namespace

Section areasSection(const Report& report) {
  std::string html;
  const Mesh& mesh = report.open.front().mesh();
  for (const AreaMeasures& area : report.areas) {
    html +=
        "<h3>" + escaped(area.name) + "</h3>\n" +
        table({"sites", "stations", "preparing, s", "query, ns", "median", "95 %", "99 %"},
              tableRow({std::to_string(area.sites), std::to_string(area.stations),
                        formatNumber(area.seconds_to_prepare), formatNumber(area.nanoseconds, 3),
                        formatShare(area.bound.median), formatShare(area.bound.percentile_95),
                        formatShare(area.bound.percentile_99)}));
    html += "<p>" + escaped(describeProbes(area, report)) + "</p>\n";
    const ColourScale scale(boundsAndErrors(area));
    html += colourKey(scale);
    std::string maps;
    for (const MapView& view : viewsOf(mesh))
      maps += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                          svgOf(mesh, area, scale, view), view.title);
    html += figures(maps) + depthPlot(area);
  }
  return {
      "areas", "Over the surface",
      "The error bound of the one energy that a finger feels anywhere on its area, as a share of "
      "the force (where that is small, of the force at which the allowed error is the floor): "
      "displacements within 45 degrees of the inward normal, by forces up to the largest of the "
      "scene. Dots are errors, at exact solutions that nothing but this measuring uses (probes).",
      html};
}

}  // namespace palpate
