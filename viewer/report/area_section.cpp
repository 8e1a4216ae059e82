#include <fmt/format.h>

#include <algorithm>

#include "viewer/report/organ_map.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

constexpr double least_shown = 1e-3;  // what is less has the same colour

std::vector<double> boundsAndErrors(const AreaMeasures& area) {
  std::vector<double> values = area.on_triangles;
  values.insert(values.end(), area.worst_on_triangles.begin(), area.worst_on_triangles.end());
  for (const AreaProbes::Comparison& probe : area.probes.comparisons)
    values.push_back(std::max(probe.error, least_shown));
  return values;
}

Figure depthFigure(const AreaMeasures& area) {
  Plot plot = {.title = "Over displacement",
               .x = {"displacement, mm", false},
               .y = {"share of the force", true},
               .series = {{.label = "bound, median", .style = seriesStyle(0)},
                          {.label = "bound, 95 %", .style = seriesStyle(1)}},
               .width = 640};
  for (const DepthMeasures& depth : area.depths) {
    plot.series[0].add(1e3 * depth.depth, depth.bound.median);
    plot.series[1].add(1e3 * depth.depth, depth.bound.percentile_95);
  }
  PlotSeries errors = {.label = "error at probes", .style = seriesStyle(2), .line = false};
  for (const AreaProbes::Comparison& probe : area.probes.comparisons)
    errors.add(1e3 * probe.displacement.norm(), probe.error);
  if (!area.probes.comparisons.empty()) plot.series.push_back(std::move(errors));
  return {.key = legendOf(plot.series),
          .caption =
              "Error bound as a share of the force (1 is all of it), logarithmic, against "
              "the length of the displacement in mm: median and 95th percentile over the "
              "middles of all triangles and five directions within 45 degrees of the inward "
              "normal. Triangles: errors at the probes of the dataset, where it has some.",
          .panels = {panelOf(plot)},
          .layout = "single"};
}

/// Eqs. 13 and 14 at the probes, one by one.
Figure probesFigure(const AreaMeasures& area) {
  Plot absolute = {.title = "Absolute error",
                   .x = {"displacement, mm"},
                   .y = {"error, N", true},
                   .series = {{.label = "one energy over the area", .style = seriesStyle(0)},
                              {.label = "nearest site alone", .style = seriesStyle(1)}}};
  for (PlotSeries& series : absolute.series) series.line = false;
  Plot relative = absolute;
  relative.title = "Relative error";
  relative.y.label = "error, %";
  for (const AreaProbes::Comparison& probe : area.probes.comparisons) {
    const double way = 1e3 * probe.displacement.norm(),
                 share = 100 / std::max(probe.force.norm(), relative_error_floor);
    absolute.series[0].add(way, probe.newtons);
    absolute.series[1].add(way, probe.newtons_of_nearest);
    relative.series[0].add(way, share * probe.newtons);
    relative.series[1].add(way, share * probe.newtons_of_nearest);
  }
  const ErrorMeasures &one = area.probes.area, &nearest = area.probes.nearest_site;
  return {
      .key = legendOf(absolute.series),
      .caption = fmt::format(
          "Eqs. 13 and 14 of Peterlik et al. 2010 over the way, logarithmic; a mark is one "
          "probe, an exact solution that no interpolation has seen. (a) |interpolated &minus; "
          "exact force| in newtons: mean {} and maximum {} by one energy, {} and {} by the "
          "nearest site. (b) The same divided by |exact force|, or by {} N where that is more, "
          "in percent: {} and {}, {} and {}. The paper takes the three components one by one "
          "and divides by the component, which may be zero.",
          formatNumber(one.error.mean), formatNumber(one.error.maximum),
          formatNumber(nearest.error.mean), formatNumber(nearest.error.maximum),
          relative_error_floor, formatShare(one.relative.mean), formatShare(one.relative.maximum),
          formatShare(nearest.relative.mean), formatShare(nearest.relative.maximum)),
      .panels = {panelOf(absolute), panelOf(relative)},
      .layout = "two"};
}

/// The bound in each place, one of its values there (`which`).
Figure mapFigure(const Report& report, const AreaMeasures& area, const std::vector<double>& values,
                 const ColourScale& scale, const char* which) {
  const Dataset& dataset = report.open.front();
  OrganMap map = {.on_triangles = values, .values = "share of the force (1 is all)"};
  map.fixed = fixedOnSurface(dataset);
  for (const AreaProbes::Comparison& probe : area.probes.comparisons)
    map.marks.push_back({probe.place, probe.error,
                         fmt::format("{} at {:.3g} mm", formatShare(probe.error),
                                     1e3 * probe.displacement.norm())});
  return {.key = legendOfMap(scale, ColourUnit::share,
                             map.marks.empty() ? "" : "probe, in the colour of the error there"),
          .caption = fmt::format(
              "The organ with its error, {0}: the {0} error bound in the middle of each triangle "
              "as a share of the force, over five depths up to {1:.3g} mm and five directions "
              "within 45 degrees of the inward normal, by forces up to {2:.3g} N; logarithmic "
              "colours, without perspective.{3}",
              which, 1e3 * dataset.spaces().front().lattice.radius(),
              dataset.scene().workspace.max_force,
              map.marks.empty() ? " This dataset has no probes to hold the bound against."
                                : " Discs are errors at probes, exact solutions."),
          .panels = panelsOf(dataset.mesh(), map, scale, ColourUnit::share)};
}

}  // namespace

Section areasSection(const Report& report, FigureNumbers& numbers) {
  std::string html;
  for (const AreaMeasures& area : report.areas) {
    html +=
        "<h3>" + escaped(area.name) + "</h3>\n" +
        table({"sites", "stations", "preparing, s", "query, ns", "exact", "error, median", "95 %",
               "bound, median", "95 %"},
              tableRow({std::to_string(area.sites), std::to_string(area.stations),
                        formatNumber(area.seconds_to_prepare), formatNumber(area.nanoseconds, 3),
                        std::to_string(area.probes.comparisons.size()),
                        formatShare(area.probes.error.median),
                        formatShare(area.probes.error.percentile_95),
                        formatShare(area.bound.median), formatShare(area.bound.percentile_95)}));
    html += "<p>" + escaped(describeProbes(area, report)) + "</p>\n";
    // One scale, so that the two maps can be compared.
    const ColourScale scale(boundsAndErrors(area));
    html += numbers.html(mapFigure(report, area, area.on_triangles, scale, "median"));
    html += numbers.html(mapFigure(report, area, area.worst_on_triangles, scale, "largest"));
    html += numbers.html(depthFigure(area));
    if (!area.probes.comparisons.empty()) html += numbers.html(probesFigure(area));
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
