#include <fmt/format.h>

#include "viewer/report/force_curves.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

std::vector<PlotSeries> areaSeries() {
  return {{.label = "one energy over the area", .style = seriesStyle(0)},
          {.label = "nearest site alone", .style = seriesStyle(1)}};
}

Figure axesFigure(const Report& report, const NodePictures& pictures) {
  Figure figure = {.key = legendOf(curveSeries(methodSeries(report), ExactMarks::solved)),
                   .caption = fmt::format(
                       "Force at {} along the axes through rest: the force of the tissue on the "
                       "tool along the direction of motion, in newtons, against the displacement "
                       "in mm, by each method from {} as it is. Marks are exact: equilibria that "
                       "were solved and that the methods interpolate.",
                       escaped(report.nodes[pictures.node].name),
                       escaped(report.datasets.front().file.filename().string()))};
  for (const ForceWay& axis : pictures.axes)
    figure.panels.push_back(
        panelOf(forcePlot(axis, methodSeries(report), "Along " + axis.name, "along " + axis.name)));
  return figure;
}

Figure heldOutFigure(const Report& report, const NodePictures& pictures) {
  Figure figure = {
      .key = legendOf(curveSeries(methodSeries(report), ExactMarks::both)),
      .caption = fmt::format(
          "Force at {} on ways from rest to exact solutions that no method has seen ({}), by each "
          "method from {}: the one where the default method errs most, the one at 95 % of them, "
          "and the median. Force along the way in newtons against the distance from rest in mm. "
          "How far a curve passes from the mark of an exact solution is its error along the way.",
          escaped(report.nodes[pictures.node].name), name(report.held_out_kind),
          escaped(shownLattice(report).label))};
  for (const ForceWay& way : pictures.ways)
    figure.panels.push_back(panelOf(
        forcePlot(way, methodSeries(report), "To the " + std::string(way.name), "along the way"),
        describeDirection(way.direction)));
  return figure;
}

/// Of one kind: sites, whose marks are solved, or probes.
Figure areaFigure(const AreaMeasures& area, bool to_probes, const char* caption) {
  Figure figure = {.key = legendOf(curveSeries(
                       areaSeries(), to_probes ? ExactMarks::held_out : ExactMarks::solved)),
                   .caption = caption};
  for (const ForceWay& way : area.ways)
    if (way.held_out.displacements.empty() != to_probes)
      figure.panels.push_back(panelOf(
          forcePlot(way, areaSeries(), to_probes ? "To the probe of the " + way.name : way.name,
                    "along the way"),
          describeDirection(way.direction)));
  return figure;
}

std::string areaCurves(const Report& report, FigureNumbers& numbers) {
  std::string html;
  for (const AreaMeasures& area : report.areas) {
    const std::array<Figure, 2> figures = {
        areaFigure(area, false,
                   "Force at three sites of the finger on the way into the body, along the axis "
                   "of the lattice nearest to the inward normal, in newtons, against the "
                   "displacement in mm. Marks are exact: equilibria that were solved at the site; "
                   "beyond the force limit of the scene curves need not lead through them. "
                   "The curve ends where the area does not answer."),
        areaFigure(area, true,
                   "Force on the way from rest to probes, exact solutions that no interpolation "
                   "has seen: the one with the largest relative error, the one at 95 % of them, "
                   "and the median. In newtons, against the distance from rest in mm. How far a "
                   "curve passes from the mark is its error along the way.")};
    html += "<h3>" + escaped(area.name) + "</h3>\n";
    for (const Figure& figure : figures)
      if (!figure.panels.empty()) html += numbers.html(figure);
  }
  return html;
}

}  // namespace

Section curvesSection(const Report& report, FigureNumbers& numbers) {
  std::string html = areaCurves(report, numbers);
  for (const NodePictures& pictures : report.pictures) {
    html += "<h3>" + escaped(report.nodes[pictures.node].name) + "</h3>\n" +
            numbers.html(axesFigure(report, pictures));
    if (!pictures.ways.empty()) html += numbers.html(heldOutFigure(report, pictures));
  }
  return {"curves", "Force against way",
          "The force of the tissue on the tool along the direction of motion. "
          "Marks are exact solutions; where curves part between marks, methods disagree." +
              (report.areas_alone ? "" : describePictured(report)),
          html};
}

}  // namespace palpate
