#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/index.hpp"
#include "viewer/report/organ_map.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

/// Discs beyond which they would cover the colours of the triangles.
constexpr std::size_t most_discs = 150;

/// Of the vertices of a mesh, where active nodes are; NaN elsewhere.
std::vector<double> atVertices(const Report& report, double Spread::*which) {
  const Dataset& dataset = report.open.front();
  std::vector<double> values(dataset.mesh().nodes.size(), not_measured);
  for (std::size_t n = 0; n < report.nodes.size(); ++n)
    values[at(dataset.spaces()[n].patch.node)] = report.nodes[n].bound.*which;
  return values;
}

/// A triangle has the mean of its corners where all three are active.
OrganMap nodeMap(const Report& report, double Spread::*which) {
  const Dataset& dataset = report.open.front();
  const std::vector<double> values = atVertices(report, which);
  OrganMap map = {.fixed = fixedOnSurface(dataset), .values = "error bound (N)"};
  for (const auto& [a, b, c] : dataset.mesh().surface)
    map.on_triangles.push_back((values[at(a)] + values[at(b)] + values[at(c)]) / 3);
  if (report.nodes.size() > most_discs) return map;
  for (std::size_t n = 0; n < report.nodes.size(); ++n) {
    const double bound = report.nodes[n].bound.*which;
    map.marks.push_back({dataset.mesh().nodes[at(dataset.spaces()[n].patch.node)], bound,
                         fmt::format("{}: {} N", report.nodes[n].name, formatNumber(bound))});
  }
  return map;
}

Figure organFigure(const Report& report, double Spread::*which, const char* word,
                   const ColourScale& scale) {
  const OrganMap map = nodeMap(report, which);
  return {.key = legendOfMap(scale, ColourUnit::newtons,
                             map.marks.empty() ? "" : "active node, in the colour of its bound"),
          .caption = fmt::format(
              "The organ with its error, {0}: each active node has the colour of the {0} error "
              "bound of {1} over its workspace ball, in newtons, on {2}; between three active "
              "nodes a triangle has their mean. Without perspective; logarithmic colours.",
              word, escaped(report.methods.front()), escaped(shownLattice(report).label)),
          .panels = panelsOf(report.open.front().mesh(), map, scale, ColourUnit::newtons)};
}

}  // namespace

std::vector<std::int32_t> fixedOnSurface(const Dataset& dataset) {
  std::vector<std::int32_t> fixed;
  std::ranges::set_intersection(dataset.fixedNodes(), dataset.surfaceNodes(),
                                std::back_inserter(fixed));
  return fixed;
}

Section organSection(const Report& report, FigureNumbers& numbers) {
  std::vector<double> bounds;
  for (const NodeMeasures& node : report.nodes)
    bounds.insert(bounds.end(), {node.bound.mean, node.bound.maximum});
  const bool has_bounds =
      std::ranges::any_of(bounds, [](double bound) { return std::isfinite(bound); });
  // One scale, so that the two maps can be compared.
  const ColourScale scale(bounds);
  std::string html;
  for (const auto& [which, word] :
       {std::pair(&Spread::mean, "mean"), std::pair(&Spread::maximum, "largest")})
    if (has_bounds) html += numbers.html(organFigure(report, which, word, scale));
  if (!has_bounds)
    html = "<p>" + escaped(report.methods.front()) +
           " gives no error bound here. The default method, potential, does.</p>\n";
  return {"organ", "Where on the organ the error is",
          fmt::format("The surface of {} as it lies at rest, from three sides.",
                      escaped(report.open.front().scene().mesh.filename().string())),
          html};
}

}  // namespace palpate
