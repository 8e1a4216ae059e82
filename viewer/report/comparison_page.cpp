#include <fmt/format.h>

#include "viewer/report/comparison.hpp"
#include "viewer/report/force_curves.hpp"
#include "viewer/report/organ_map.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

/// Far apart in colour, lightness and mark.
const std::array<SeriesStyle, 2> side_styles = {
    {{.colour = "#0072b2", .marker = 0, .width = 2.6},
     {.colour = "#d55e00", .dash = "7 3", .marker = 1, .width = 2.2}}};

/// "A, liver-mr"
std::string sideName(const Comparison& comparison, std::size_t side) {
  return fmt::format("{}, {}", side == 0 ? 'A' : 'B',
                     comparison.datasets[side].file.stem().string());
}

/// Marks on top of curves: exact solutions of both, then what is interpolated between them.
std::vector<PlotSeries> sideSeries(const Comparison& comparison) {
  std::vector<PlotSeries> series;
  for (std::size_t s = 0; s < 2; ++s)
    series.push_back({.label = fmt::format("{}: exact, solved", s == 0 ? 'A' : 'B'),
                      .style = side_styles[s],
                      .line = false});
  for (std::size_t s = 0; s < 2; ++s)
    series.push_back({.label = sideName(comparison, s), .style = side_styles[s], .marks = false});
  return series;
}

Plot axisPlot(const Comparison& comparison, const ComparedPlace& place, std::size_t axis) {
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  Plot plot = {.title = fmt::format("Along {}", names[axis]),
               .x = {fmt::format("displacement along {}, mm", names[axis])},
               .y = {fmt::format("force along {}, N", names[axis])},
               .series = sideSeries(comparison),
               .width = 380,
               .height = 290};
  for (std::size_t s = 0; s < 2; ++s) {
    const ForceWay& way = place.axes[axis][s];
    addForces(way.solved, plot.series[s]);
    addForces(way.sampled.front(), plot.series[2 + s]);
  }
  return plot;
}

std::string axesOf(const Comparison& comparison, const ComparedPlace& place,
                   FigureNumbers& numbers) {
  Figure figure = {.key = legendOf(sideSeries(comparison)),
                   .caption = fmt::format(
                       "Force at {} along the same displacements in both: the force of the tissue "
                       "on the tool along the direction of motion, in newtons, against the "
                       "displacement in mm, through rest. Curves are {}; marks are exact, "
                       "equilibria that were solved. A curve ends where its dataset does not "
                       "answer.",
                       escaped(place.name), escaped(comparison.method))};
  for (std::size_t axis = 0; axis < 3; ++axis)
    figure.panels.push_back(panelOf(axisPlot(comparison, place, axis)));
  return numbers.html(figure);
}

std::string distancesOf(const Comparison& comparison, const ComparedPlace& place,
                        FigureNumbers& numbers) {
  Plot force = {.title = "Forces",
                .x = {"way from rest, mm"},
                .y = {"mean |force|, N"},
                .series = {{.label = sideName(comparison, 0), .style = side_styles[0]},
                           {.label = sideName(comparison, 1), .style = side_styles[1]},
                           {.label = "|B − A|", .style = {.colour = "#3d454d", .marker = 2}}}};
  Plot ratio = {
      .title = "B relative to A",
      .x = {"way from rest, mm"},
      .y = {"share of mean |force of A|, %"},
      .series = {{.label = "|B| / |A|", .style = side_styles[1]},
                 {.label = "|B − A| / |A|", .style = {.colour = "#3d454d", .marker = 2}}}};
  for (PlotSeries& series : force.series) series.marks = false;
  for (PlotSeries& series : ratio.series) series.marks = false;
  for (const ForceAtDistance& at : place.distances) {
    const double way = 1e3 * at.distance;
    force.series[0].add(way, at.first);
    force.series[1].add(way, at.second);
    force.series[2].add(way, at.difference);
    // At rest there is no force to be relative to.
    if (!(at.first > 0) || at.distance == 0) continue;
    ratio.series[0].add(way, 100 * at.second / at.first);
    ratio.series[1].add(way, 100 * at.difference / at.first);
  }
  return numbers.html(
      {.key = legendOf(force.series),
       .caption = fmt::format(
           "How the two part at {}, over the distance from rest in mm: (a) mean length of the "
           "force of each, and of the difference of the force vectors, in newtons, (b) the same "
           "in percent of the force of A. Means over 26 directions, by {}.",
           escaped(place.name), escaped(comparison.method)),
       .panels = {panelOf(force), panelOf(ratio)},
       .layout = "two"});
}

std::string differencesTable(const Comparison& comparison) {
  std::string rows;
  for (const ComparedPlace& place : comparison.places) {
    const auto& [a, b] = place.sides;
    rows += tableRow({place.name, formatNumber(1e3 * place.apart, 3),
                      std::to_string(place.displacements), formatNumber(a.stiffness, 3),
                      formatNumber(b.stiffness, 3), formatNumber(a.mean_force, 3),
                      formatNumber(b.mean_force, 3), formatNumber(place.difference.mean),
                      formatNumber(place.difference.maximum), formatShare(place.relative),
                      formatNumber(a.mean_bound), formatNumber(b.mean_bound)});
  }
  return table({"active node", "apart, mm", "displace­ments", "stiffness A, N/m",
                "stiffness B, N/m", "mean |force| A, N", "mean |force| B, N", "|B − A| mean, N",
                "|B − A| max, N", "of force A", "bound A, N", "bound B, N"},
               rows);
}

/// Where on the first body they differ; nothing where there is one place only.
std::string differenceMap(const Comparison& comparison, FigureNumbers& numbers) {
  if (comparison.everywhere.size() < 2) return "";
  OrganMap map = {.fixed = fixedOnSurface(comparison.open[0]),
                  .values = "|B - A| as a share of the force of A (1 is all)"};
  std::vector<double> values;
  for (const PlaceDifference& at : comparison.everywhere) {
    values.push_back(at.relative);
    map.marks.push_back(
        {at.place, at.relative, fmt::format("{}: {}", at.name, formatShare(at.relative))});
  }
  const ColourScale scale(values);
  return numbers.html(
      {.key = legendOfMap(scale, ColourUnit::share, "active node, in the colour of the difference"),
       .caption = fmt::format(
           "Where they differ, on the surface of A from three sides: mean length of the "
           "difference of the force vectors as a share of the mean force of A, over the "
           "displacements of a grid in the workspace ball, at {} of {} active nodes that both "
           "have, by {}; logarithmic colours, without perspective.",
           comparison.everywhere.size(), comparison.common, escaped(comparison.method)),
       .panels = panelsOf(comparison.open[0].mesh(), map, scale, ColourUnit::share)});
}

std::string propertiesTable(const Comparison& comparison) {
  std::string rows;
  for (const auto& [name, first, second] : comparison.properties)
    rows +=
        fmt::format("<tr{}><td>{}</td><td class=\"text\">{}</td><td class=\"text\">{}</td></tr>\n",
                    first == second ? "" : " class=\"differs\"", escaped(name), escaped(first),
                    escaped(second));
  return fmt::format(
      "<div class=\"scroll\"><table class=\"words\"><thead><tr><th></th><th class=\"text\">{}</th>"
      "<th class=\"text\">{}</th></tr></thead>\n<tbody>\n{}</tbody></table></div>\n",
      escaped(sideName(comparison, 0)), escaped(sideName(comparison, 1)), rows);
}

Section propertiesSection(const Comparison& comparison) {
  return {"properties", "Side by side", "What differs is set in bold.",
          propertiesTable(comparison)};
}

Section differencesSection(const Comparison& comparison, FigureNumbers& numbers) {
  std::string html = differencesTable(comparison) + differenceMap(comparison, numbers);
  for (const ComparedPlace& place : comparison.places)
    html += distancesOf(comparison, place, numbers);
  return {"differences", "Differences in numbers",
          "Over the displacements of a grid in the smaller workspace ball that both answer, with "
          "forces within the limits of their scenes. "
          "Stiffness: at rest, the mean over directions. The bounds say how sure the "
          "interpolations are: a difference below them says nothing.",
          html};
}

Section forcesSection(const Comparison& comparison, FigureNumbers& numbers) {
  std::string html;
  for (const ComparedPlace& place : comparison.places)
    html += "<h3>" + escaped(place.name) + "</h3>\n" + axesOf(comparison, place, numbers);
  return {"forces", "Force against way",
          comparison.places.size() == comparison.common
              ? "Both on the same axes, along the same displacements."
              : fmt::format("Both on the same axes, along the same displacements, at {} of {} "
                            "active nodes, evenly chosen.",
                            comparison.places.size(), comparison.common),
          html};
}

}  // namespace

std::string comparisonPage(const Comparison& comparison) {
  FigureNumbers numbers(comparison.open[0].scene().name + "-and-" +
                        comparison.open[1].scene().name);
  std::vector<Section> sections = {propertiesSection(comparison)};
  sections.push_back(forcesSection(comparison, numbers));
  sections.push_back(differencesSection(comparison, numbers));
  std::string provenance;
  for (std::size_t s = 0; s < 2; ++s)
    provenance += "<h3>" + escaped(sideName(comparison, s)) + "</h3>\n" +
                  provenanceList(comparison.open[s], comparison.datasets[s]);
  sections.push_back(
      {"provenance", "Scene and provenance", "What was computed, and by what.", provenance});
  std::string notes;
  for (const std::string& limit : comparison.limits) notes += note(limit);
  return htmlPage(
      fmt::format("{} and {}", comparison.open[0].scene().name, comparison.open[1].scene().name),
      fmt::format(
          "<p class=\"lead\">Two datasets along the same displacements. They differ in {}.</p>\n",
          escaped(fmt::format("{}", fmt::join(comparison.differences, ", ")))) +
          notes,
      sections);
}

}  // namespace palpate
