#include <fmt/format.h>

#include <algorithm>

#include "common/base/number_text.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"
#include "viewer/report/slice_picture.hpp"

namespace palpate {
namespace {

constexpr std::size_t listed_nodes = 36, plotted_nodes = 12;
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
Panel nodePanel(const Report& report, const NodeMeasures& node) {
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
  return panelOf(plot);
}

std::string nodesFigure(const Report& report, const std::vector<std::size_t>& nodes,
                        FigureNumbers& numbers) {
  // The plot of a single node is that of all nodes.
  if (!report.measured || nodes.size() < 2) return "";
  Figure figure = {.key = legendOf(methodSeries(report)),
                   .caption =
                       "Mean error of each method at single active nodes, in newtons, over "
                       "the exact solutions of the node, against its solved "
                       "configurations; one mark for each lattice density. The node with "
                       "the largest error of the default method comes first."};
  for (const std::size_t n : nodes)
    if (report.nodes[n].compared && figure.panels.size() < plotted_nodes)
      figure.panels.push_back(nodePanel(report, report.nodes[n]));
  return numbers.html(figure);
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

}  // namespace

Section nodesSection(const Report& report, FigureNumbers& numbers) {
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
    how += fmt::format(" The other methods were compared on {}, evenly chosen.",
                       counted(report.compared, "node"));
  return {"nodes", "Active nodes", how,
          nodesTable(report, listed) + nodeMethodsTable(report, all) +
              nodesFigure(report, all, numbers)};
}

Section mapsSection(const Report& report, FigureNumbers& numbers) {
  static constexpr std::array<const char*, 3> planes = {"x and y", "x and z", "y and z"};
  const ColourScale scale = scaleOf(report.pictures);
  std::string maps;
  for (const NodePictures& pictures : report.pictures) {
    const std::string& name = report.nodes[pictures.node].name;
    Figure figure = {
        .key = legendOf(scale),
        .caption = fmt::format(
            "Error bound of {} at {}, in newtons (logarithmic colours), at the displacements of "
            "three planes through rest; axes in mm, out to the rim of the workspace ball. It is "
            "sampled at {} x {} places of {}. Discs: |interpolated &minus; exact force| at exact "
            "solutions within a twentieth of the radius of the plane.",
            escaped(report.methods.front()), escaped(name), SliceMap::side, SliceMap::side,
            escaped(shownLattice(report).label))};
    for (std::size_t s = 0; s < pictures.slices.size(); ++s)
      figure.panels.push_back(panelOf(pictures.slices[s], scale, planes[s]));
    if (figure.panels.empty()) continue;
    maps += "<h3>" + escaped(name) + "</h3>\n" + numbers.html(figure);
  }
  return {"maps", "Where in the ball the error is",
          fmt::format("Colour: the error bound that {} gives at each displacement "
                      "in three planes through the rest position (axes in mm, lattice of {}). "
                      "A dot lighter than its surroundings is a bound that did not hold. "
                      "White: no bound.{}",
                      report.methods.front(), escaped(shownLattice(report).label),
                      describePictured(report)),
          maps};
}

}  // namespace palpate
