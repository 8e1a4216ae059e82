#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/number_text.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

constexpr double least_loop_work = 1e-10;  ///< drawn; what is below is the error of the sum

std::string card(const std::string& value, const std::string& meaning) {
  return fmt::format("<div class=\"card\"><b>{}</b><span>{}</span></div>\n", escaped(value),
                     escaped(meaning));
}

/// An error to plot: its name, and where it is among the measures of a method.
struct Ordinate {
  const char* name;
  ErrorMeasures MethodMeasures::*points;
  double Spread::*error;
};
constexpr std::array<Ordinate, 3> ordinates = {
    {{"Whole ball, mean", &MethodMeasures::all, &Spread::mean},
     {"Whole ball, median", &MethodMeasures::all, &Spread::median},
     {"Covered points, mean", &MethodMeasures::covered, &Spread::mean}}};

Panel frontierPanel(const Report& report, const Ordinate& ordinate, bool over_time) {
  Plot plot;
  plot.title =
      fmt::format("{}: error against {}", ordinate.name, over_time ? "time" : "configurations");
  plot.x = {over_time ? "ns per query" : "configurations per active node", true};
  plot.y = {"error of the force, N", true};
  plot.series = methodSeries(report);
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    for (const LatticeMeasures& lattice : report.lattices) {
      const MethodMeasures& method = lattice.methods[m];
      const double error = (method.*ordinate.points).error.*ordinate.error;
      // Not measured there: the lattice has what it would be measured with.
      if (!std::isfinite(error)) continue;
      plot.series[m].add(over_time ? method.nanoseconds : lattice.configurations, error,
                         fmt::format("{}, {} configurations: {} N, {} ns", report.methods[m],
                                     formatCount(lattice.configurations), formatNumber(error),
                                     formatNumber(method.nanoseconds, 3)));
    }
  return panelOf(plot);
}

std::string frontierFigure(const Report& report, FigureNumbers& numbers) {
  Figure figure = {
      .key = legendOf(methodSeries(report)),
      .caption =
          fmt::format("Error of each method against what it costs. Up: |interpolated &minus; exact "
                      "force| in newtons, mean or median over the exact solutions of {}. Right: "
                      "solved configurations per active node (a, c, e), or the time of one query "
                      "in nanoseconds on the machine that made this page (b, d, f). Each mark is "
                      "one lattice density. Covered: all eight corners around are solved. {}",
                      counted(report.compared, "active node"), escaped(describeHeldOut(report))),
      .layout = "two"};
  for (const Ordinate& ordinate : ordinates)
    for (const bool over_time : {false, true})
      figure.panels.push_back(frontierPanel(report, ordinate, over_time));
  return numbers.html(figure);
}

std::string frontierRow(const std::string& name, const LatticeMeasures& lattice,
                        const MethodMeasures& method) {
  const std::string configurations = formatCount(lattice.configurations);
  if (!method.problem.empty() && method.all.count == 0)
    return tableRow({name, configurations},
                    "<td class=\"reason\" colspan=\"12\">" + escaped(method.problem) + "</td>");
  const Spread &error = method.all.error, &covered = method.covered.error;
  return tableRow({name, configurations, formatNumber(error.mean), formatNumber(error.median),
                   formatNumber(error.percentile_95), formatNumber(error.maximum),
                   formatNumber(covered.mean), formatNumber(covered.maximum),
                   formatShare(method.all.relative.mean), formatShare(method.all.within_target),
                   formatShare(method.all.covered), formatNumber(method.loop_work),
                   formatNumber(method.nanoseconds, 3),
                   formatNumber(1e3 * method.seconds_to_prepare)});
}

/// The rows of a method stand together, under a line.
std::string frontierTable(const Report& report) {
  std::string rows;
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    if (m > 0) rows += "</tbody><tbody>\n";
    for (const LatticeMeasures& lattice : report.lattices)
      rows += frontierRow(&lattice == &report.lattices.front() ? report.methods[m] : "", lattice,
                          lattice.methods[m]);
  }
  return table({"method", "configu­rations", "mean", "median", "95 %", "max", "mean, covered",
                "max, covered", "relative", "in target", "covered", "loop work", "ns per query",
                "ms to prepare"},
               rows);
}

std::string latticeTable(const Report& report) {
  std::string rows;
  for (const LatticeMeasures& lattice : report.lattices)
    rows += tableRow({lattice.label, fmt::format("{:.4g}", 1e3 * lattice.spacing),
                      formatCount(lattice.configurations), formatCount(lattice.factorizations)});
  return table({"lattice", "spacing, mm", "configurations", "factorizations they took"}, rows);
}

std::string areaCards(const AreaMeasures& area, const Report& report) {
  std::string probes;
  if (area.probes.area.count > 0)
    probes = card(formatShare(area.probes.area.within_target),
                  "of exact solutions within " + describeTarget(report)) +
             card(formatShare(area.probes.area.relative.median),
                  "of the force is the error, in the median");
  return "<p class=\"how\">A finger anywhere on " + escaped(area.name) +
         ":</p>\n<div class=\"cards\">\n" + probes +
         card(formatShare(area.bound.median), "of the force is the error bound, in the median") +
         card(formatShare(area.bound.percentile_95), "is it at most at 95 % of places") +
         card(std::to_string(area.sites), "sites on the surface") +
         card(formatNumber(area.seconds_to_prepare) + " s", "to prepare its energy") +
         card(formatNumber(1e-3 * area.nanoseconds, 2) + " us",
              "per query, on the machine that made this page") +
         "</div>\n";
}

}  // namespace

std::vector<PlotSeries> methodSeries(const Report& report) {
  std::vector<PlotSeries> series;
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    series.push_back({.label = report.methods[m], .style = seriesStyle(m)});
  return series;
}

std::string cards(const Report& report) {
  // What is felt is the area; how methods do at single sites is below.
  if (!report.areas.empty()) return areaCards(report.areas.front(), report);
  const LatticeMeasures& lattice = firstAsItIs(report);
  PALPATE_ASSERT(lattice.methods.size() == report.methods.size(),
                 "every lattice was measured with every method, the default first");
  const MethodMeasures& method = lattice.methods.front();
  std::string errors;
  // Without probes there may be those of a part of it, which say little of the whole.
  if (method.all.count > 0)
    errors =
        card(formatNumber(method.all.error.mean) + " N", "mean error, whole ball") +
        card(formatShare(method.all.relative_to_mean_force), "the same, of the mean force") +
        card(formatShare(method.all.within_target),
             "of exact solutions within " + describeTarget(report)) +
        card(formatShare(method.all.covered), "of them lie in cells whose 8 corners are solved");
  return fmt::format("<p class=\"how\">The method {} on {}:</p>\n<div class=\"cards\">\n",
                     escaped(report.methods.front()), escaped(lattice.label)) +
         errors +
         card(formatNumber(method.nanoseconds, 3) + " ns",
              "per query, on the machine that made this page") +
         card(formatCount(lattice.configurations), "configurations per active node") + "</div>\n";
}

Section frontierSection(const Report& report, FigureNumbers& numbers) {
  std::string html;
  // Without exact solutions the plots would be empty; the table still has times.
  if (report.held_out_kind != HeldOutKind::none) html += frontierFigure(report, numbers);
  html += "<h3>In numbers</h3>\n" + frontierTable(report) + latticeTable(report);
  for (const std::string& gap : describeGaps(report)) html += note(gap);
  html += fmt::format(
      "<p class=\"how\">Errors are |interpolated &minus; exact force| in newtons. Relative: "
      "divided by the force, or by {} N where that is more. In target: at most {}. Covered: "
      "the eight corners around are solved; the same points for every method.</p>\n",
      relative_error_floor, escaped(describeTarget(report)));
  return {"frontier", "Speed against error",
          "Lower is more accurate, further left is cheaper; "
          "a curve below another gives the same accuracy from fewer configurations. "
          "Each mark is one lattice density.",
          html};
}

Section loopsSection(const Report& report, FigureNumbers& numbers) {
  Plot plot;
  plot.title = "Work around closed loops";
  plot.x = {"configurations per active node", true};
  plot.y = {"work / effort", true};
  plot.width = 640;
  plot.series = methodSeries(report);
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    for (const LatticeMeasures& lattice : report.lattices) {
      const double work = lattice.methods[m].loop_work;
      plot.series[m].add(lattice.configurations,
                         std::isfinite(work) ? std::max(work, least_loop_work) : work,
                         fmt::format("{}, {} configurations: {}", report.methods[m],
                                     formatCount(lattice.configurations), formatNumber(work)));
    }
  return {"loops", "Closed loops",
          "Work that a hand gains or loses around circles of a quarter of the workspace radius, "
          "divided by the force times the way; the largest found. "
          "Tissue gives back what it took: a method that does not can shake a device. "
          "10⁻¹⁰ stands for nothing but the error of the sum. "
          "Where a method gives way to tri-linear interpolation, "
          "at jumps between branches, its loops leak too.",
          numbers.html({.key = legendOf(plot.series),
                        .caption = "Work around closed loops, |sum of F&middot;dp| / sum of "
                                   "|F||dp|, without a unit, against solved configurations per "
                                   "active node; one mark for each lattice density. The largest "
                                   "of 64 circles with random centres and planes, by 4096 "
                                   "positions of the interpolated force on each.",
                        .panels = {panelOf(plot)},
                        .layout = "single"})};
}

Section boundsSection(const Report& report) {
  std::string rows;
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    if (const ErrorMeasures& measures = shownLattice(report).methods[m].all; measures.bounds > 0)
      rows += tableRow({report.methods[m], std::to_string(measures.bounds),
                        formatShare(measures.bound_holds),
                        formatNumber(measures.bound_over_error.median)});
  return {
      "bounds", "Error bounds",
      "Methods say themselves how wrong they may be. "
      "A good bound holds almost always and is not many times the error.",
      rows.empty()
          ? "<p>No method gave bounds here.</p>\n"
          : table({"method", "bounds given", "error within bound", "bound / error, median"}, rows)};
}

}  // namespace palpate
