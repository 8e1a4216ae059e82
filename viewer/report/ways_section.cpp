#include <fmt/format.h>

#include "common/base/number_text.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

/// One of Eqs. 13 and 14: what is drawn, and how it is taken from the measures of a shell.
struct WayError {
  const char* title;
  const char* unit;
  double (*of)(const ErrorMeasures&);
};
using WayErrors = std::array<WayError, 4>;

constexpr WayErrors of_vectors = {
    {{"Mean absolute error", "N", [](const ErrorMeasures& m) { return m.error.mean; }},
     {"Maximum absolute error", "N", [](const ErrorMeasures& m) { return m.error.maximum; }},
     {"Mean relative error", "%", [](const ErrorMeasures& m) { return 100 * m.relative.mean; }},
     {"Maximum relative error", "%",
      [](const ErrorMeasures& m) { return 100 * m.relative.maximum; }}}};
constexpr WayErrors of_components = {
    {{"Eq. 13, mean", "N", [](const ErrorMeasures& m) { return m.mean_component; }},
     {"Eq. 13, maximum", "N", [](const ErrorMeasures& m) { return m.max_component; }},
     {"Eq. 14, mean", "%", [](const ErrorMeasures& m) { return 100 * m.mean_relative_component; }},
     {"Eq. 14, maximum", "%",
      [](const ErrorMeasures& m) { return 100 * m.max_relative_component; }}}};

Plot wayPlot(const Report& report, const WayError& error) {
  Plot plot = {.title = error.title,
               .x = {"way from rest, mm"},
               .y = {fmt::format("error, {}", error.unit), true},
               .series = methodSeries(report)};
  for (const WayShell& shell : report.ways)
    for (std::size_t m = 0; m < report.methods.size(); ++m) {
      const ErrorMeasures& measures = shell.methods[m];
      // No exact solution lies there: the curve goes on at the next.
      if (measures.count == 0) continue;
      plot.series[m].add(500 * (shell.from + shell.to), error.of(measures),
                         fmt::format("{}, {:.3g} to {:.3g} mm, {} exact solutions: {} {}",
                                     report.methods[m], 1e3 * shell.from, 1e3 * shell.to,
                                     measures.count, formatNumber(error.of(measures)), error.unit));
    }
  return plot;
}

std::string waysFigure(const Report& report, const WayErrors& errors, const std::string& caption,
                       FigureNumbers& numbers) {
  Figure figure = {.key = legendOf(methodSeries(report)), .caption = caption, .layout = "two"};
  for (const WayError& error : errors) figure.panels.push_back(panelOf(wayPlot(report, error)));
  return numbers.html(figure);
}

std::string waysTable(const Report& report) {
  std::string rows;
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    const ErrorMeasures& all = shownLattice(report).methods[m].all;
    if (all.count == 0) continue;
    rows += tableRow({report.methods[m], std::to_string(all.count), formatNumber(all.error.mean),
                      formatNumber(all.error.maximum), formatShare(all.relative.mean),
                      formatShare(all.relative.maximum), formatNumber(all.mean_component),
                      formatNumber(all.max_component), formatShare(all.mean_relative_component),
                      formatShare(all.max_relative_component)});
  }
  return "<h3>In numbers, all ways together</h3>\n" +
         table({"method", "exact solutions", "mean, N", "max, N", "relative, mean", "relative, max",
                "Eq. 13 mean, N", "Eq. 13 max, N", "Eq. 14 mean", "Eq. 14 max"},
               rows);
}

}  // namespace

Section waysSection(const Report& report, FigureNumbers& numbers) {
  const std::string how =
      "Eqs. 13 and 14 of Peterlik et al. 2010: mean and maximum, absolute and relative error of "
      "the interpolated force against exact solutions, over the way from rest.";
  if (report.ways.empty())
    return {"ways", "Error along the way", how,
            "<p>" + escaped(describeHeldOut(report)) + "</p>\n"};
  const std::string where = fmt::format(
      "Against the length of the displacement in mm, in {} shells of equal thickness around rest; "
      "logarithmic. Marks are at the middles of the shells; over them is from how many exact "
      "solutions. Measured on {} with {} exact solutions of {} ({}).",
      way_shells, escaped(shownLattice(report).label),
      shownLattice(report).methods.front().all.count, counted(report.compared, "active node"),
      name(report.held_out_kind));
  std::string html =
      waysFigure(report, of_vectors,
                 fmt::format("Error of the force vector: (a, b) |interpolated &minus; exact force| "
                             "in newtons, (c, d) the same divided by |exact force|, or by {} N "
                             "where that is more, in percent. {} This departs from Eqs. 13 and 14, "
                             "which take the three components one by one and divide by the "
                             "component: that is zero wherever the way is symmetric.",
                             relative_error_floor, where),
                 numbers);
  // In a statement of its own: the figures are numbered in the order in which they are made.
  html +=
      waysFigure(report, of_components,
                 fmt::format("The same by the paper's equations: over points and the components "
                             "i = x, y, z, (a, b) |interpolated<sub>i</sub> &minus; "
                             "exact<sub>i</sub>| in newtons, (c, d) divided by "
                             "|exact<sub>i</sub>| in percent. One thing is not the paper's: a "
                             "component below {0} N counts as {0} N. {1}",
                             relative_error_floor, where),
                 numbers) +
      waysTable(report);
  return {"ways", "Error along the way", how, html};
}

}  // namespace palpate
