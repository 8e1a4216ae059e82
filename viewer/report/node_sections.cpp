#include <fmt/format.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"
#include "viewer/report/slice_picture.hpp"

namespace palpate {
namespace {

constexpr std::size_t listed_nodes = 36, plotted_nodes = 12;
constexpr const char* mark_colour = "#1b1f24";
constexpr double graph_width = 380, graph_height = 290;

std::string nodesTable(const Report& report, const std::vector<std::size_t>& nodes) {
  std::string rows;
  for (const std::size_t n : nodes) {
    const NodeMeasures& node = report.nodes[n];
    const ErrorMeasures& measures = node.methods.front();
    std::vector<std::string> cells = {node.name};
    for (const Tag tag : {Tag::expandable, Tag::terminating, Tag::failed})
      cells.push_back(std::to_string(node.tags[static_cast<std::size_t>(tag)]));
    cells.insert(cells.end(),
                 {std::to_string(node.jumps), formatNumber(node.largest_force, 3),
                  std::to_string(node.held_out), formatNumber(measures.error.mean),
                  formatNumber(measures.error.median), formatNumber(measures.error.percentile_95),
                  formatNumber(measures.error.maximum), formatShare(measures.within_target),
                  formatShare(measures.bound_holds)});
    rows += tableRow(cells);
  }
  return table({"active node", "expandable", "terminating", "failed", "jumps", "largest force, N",
                "exact solutions", "mean", "median", "95 %", "max", "in target", "within bound"},
               rows);
}

/// Mean errors, a column per method.
std::string nodeMethodsTable(const Report& report, const std::vector<std::size_t>& nodes) {
  // One method is in the table above already.
  if (report.methods.size() < 2) return "";
  std::vector<std::string> titles = {"mean error, N"};
  titles.insert(titles.end(), report.methods.begin(), report.methods.end());
  std::string rows;
  for (const std::size_t n : nodes) {
    const NodeMeasures& node = report.nodes[n];
    if (!node.compared) continue;
    std::vector<std::string> cells = {node.name};
    for (const ErrorMeasures& method : node.methods)
      cells.push_back(formatNumber(method.error.mean));
    rows += tableRow(cells);
  }
  return table(titles, rows);
}

/// Error against configurations of one compared active node.
std::string nodePlot(const Report& report, const NodeMeasures& node) {
  Plot plot = {.title = node.name,
               .x = {"configurations", true},
               .y = {"mean error, N", true},
               .series = methodSeries(report),
               .width = graph_width,
               .height = graph_height};
  for (const LatticeMeasures& lattice : report.lattices)
    if (!lattice.node_errors.empty())
      for (std::size_t m = 0; m < report.methods.size(); ++m)
        plot.series[m].add(lattice.node_configurations[*node.compared],
                           lattice.node_errors[*node.compared][m]);
  return svgOf(plot);
}

std::string nodePlots(const Report& report, const std::vector<std::size_t>& nodes) {
  // The plot of a single node is that of all nodes.
  if (!report.measured || nodes.size() < 2) return "";
  std::string plots;
  std::size_t count = 0;
  for (const std::size_t n : nodes)
    if (report.nodes[n].compared && count++ < plotted_nodes)
      plots += nodePlot(report, report.nodes[n]);
  return legendOf(methodSeries(report)) + figures(plots);
}

/// Limits around the bounds and errors of all pictures.
ColourScale scaleOf(const std::vector<NodePictures>& pictures) {
  std::vector<double> values;
  for (const NodePictures& node : pictures)
    for (const SliceMap& slice : node.slices) {
      values.insert(values.end(), slice.bound.begin(), slice.bound.end());
      for (const SliceMap::ErrorMark& mark : slice.errors) values.push_back(mark.error);
    }
  return ColourScale(values);
}

std::string headingOf(const Report& report, const NodePictures& pictures) {
  return "<h3>" + escaped(report.nodes[pictures.node].name) + "</h3>\n";
}

std::string whichNodes(const Report& report) {
  return report.pictures.size() == report.nodes.size()
             ? ""
             : fmt::format(" The {} active nodes with the largest errors.", report.pictures.size());
}

/// The curves of a plot along an axis: of the methods, below the marks of the exact solutions.
std::vector<PlotSeries> curves(const Report& report) {
  std::vector<PlotSeries> series = methodSeries(report);
  for (PlotSeries& method : series) method.marks = false;
  series.insert(series.begin(), PlotSeries{.label = "exact, lattice points",
                                           .style = {.colour = mark_colour},
                                           .line = false});
  return series;
}

void addForces(const AxisForces& along, PlotSeries& series) {
  for (std::size_t n = 0; n < along.forces.size(); ++n)
    series.add(1e3 * along.displacements[n], along.forces[n]);
}

std::string curvesAlong(const Report& report, const NodePictures& pictures, std::size_t axis) {
  PALPATE_ASSERT(pictures.sampled.size() == report.methods.size(), "samples are by method");
  static constexpr std::array<const char*, 3> names = {"x", "y", "z"};
  Plot plot = {.title = fmt::format("Along {}", names[axis]),
               .x = {fmt::format("displacement along {}, mm", names[axis])},
               .y = {fmt::format("force along {}, N", names[axis])},
               .series = curves(report),
               .width = graph_width,
               .height = graph_height};
  addForces(pictures.solved[axis], plot.series[0]);
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    addForces(pictures.sampled[m][axis], plot.series[m + 1]);
  // The default, the widest line, below the others.
  std::reverse(plot.series.begin() + 1, plot.series.end());
  return svgOf(plot);
}

}  // namespace

Section nodesSection(const Report& report) {
  const std::vector<std::size_t> all = worstFirst(report);
  std::vector<std::size_t> listed = all;
  listed.resize(std::min(all.size(), listed_nodes));
  std::string how = fmt::format("Errors of {} in newtons on {}, the worst first",
                                report.methods.front(), escaped(shownLattice(report).label));
  if (listed.size() < all.size())
    how += fmt::format(": {} of {} active nodes", listed.size(), all.size());
  how +=
      ". Jumps: edges of the lattice between different branches of solutions, "
      "across which nothing is interpolated smoothly.";
  if (report.compared < all.size())
    how += fmt::format(" The other methods were compared on {} nodes, evenly chosen.",
                       report.compared);
  return {"nodes", "Active nodes", how,
          nodesTable(report, listed) + nodeMethodsTable(report, all) + nodePlots(report, all)};
}

Section mapsSection(const Report& report) {
  static constexpr std::array<const char*, 3> planes = {
      "x and y, through rest", "x and z, through rest", "y and z, through rest"};
  const ColourScale scale = scaleOf(report.pictures);
  std::string maps = legendOf(scale);
  for (const NodePictures& pictures : report.pictures) {
    std::string slices;
    for (std::size_t s = 0; s < pictures.slices.size(); ++s)
      slices += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                            svgOf(pictures.slices[s], scale), planes[s]);
    maps += headingOf(report, pictures) + figures(slices);
  }
  return {
      "maps", "Where the error is",
      fmt::format("Colour: the error bound that {} gives at each displacement "
                  "in three planes through the rest position (axes in mm, lattice of {}). "
                  "A dot lighter than its surroundings is a bound that did not hold. "
                  "White: no bound.{}",
                  report.methods.front(), escaped(shownLattice(report).label), whichNodes(report)),
      maps};
}

Section curvesSection(const Report& report) {
  std::string html = legendOf(curves(report));
  for (const NodePictures& pictures : report.pictures) {
    std::string plots;
    for (std::size_t axis = 0; axis < 3; ++axis) plots += curvesAlong(report, pictures, axis);
    html += headingOf(report, pictures) + figures(plots);
  }
  return {
      "curves", "Force along the axes",
      fmt::format("The force of the tissue on the tool along the direction of motion, "
                  "for displacements along x, y and z, on {} as it is. "
                  "Marks are exact solutions of the lattice; "
                  "where curves part between marks, methods disagree.{}",
                  escaped(report.datasets.front().file.filename().string()), whichNodes(report)),
      html};
}

}  // namespace palpate
