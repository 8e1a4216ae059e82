#pragma once

#include "viewer/plot/figure.hpp"
#include "viewer/report/report.hpp"

// What the page of a report consists of.

namespace palpate {

/// A part of the page that its navigation leads to.
struct Section {
  const char* id;
  const char* heading;  ///< plain text
  std::string how;      ///< a sentence on how to read it, HTML as `content`
  std::string content;
};

/// The default method on the first dataset as it is, or its area, in at most seven numbers.
std::string cards(const Report& report);

/// Error against configurations and against time: plots, and the numbers.
Section frontierSection(const Report& report, FigureNumbers& numbers);
/// Error over the way from rest: Eqs. 13 and 14 of the paper.
Section waysSection(const Report& report, FigureNumbers& numbers);
/// Work around closed loops.
Section loopsSection(const Report& report, FigureNumbers& numbers);
/// How good the error bounds of the methods are.
Section boundsSection(const Report& report);

/// Points, errors and curves of single active nodes, the worst first.
Section nodesSection(const Report& report, FigureNumbers& numbers);
/// Where on the body the active nodes are, with the error bounds of their spaces.
Section organSection(const Report& report, FigureNumbers& numbers);
/// Error bounds and errors in three planes, of Report::pictures.
Section mapsSection(const Report& report, FigureNumbers& numbers);
/// Forces along the axes, of Report::pictures.
Section curvesSection(const Report& report, FigureNumbers& numbers);

/// Report::areas: bounds on a map of the organ, and over the displacement.
Section areasSection(const Report& report, FigureNumbers& numbers);

/// Failures of the first dataset, by cause.
Section failuresSection(const Report& report);
/// What takes the room in the files.
Section sizesSection(const Report& report);
/// What was computed, and by what: ids, workspace, the whole scene.
Section provenanceSection(const Report& report);

/// The fixed nodes that are on the surface, sorted.
std::vector<std::int32_t> fixedOnSurface(const Dataset& dataset);

/// Ids, workspace and whole scene of one dataset.
std::string provenanceList(const Dataset& dataset, const DatasetFacts& facts);

/// A whole page: `heading` is plain text, `lead` HTML; its navigation leads to the sections.
std::string htmlPage(const std::string& heading, const std::string& lead,
                     const std::vector<Section>& sections);

/// A labelled curve for each method, in the order of Report::methods, that has its look and no
/// points yet.
std::vector<PlotSeries> methodSeries(const Report& report);

/// A table of rows (tableRow) under titles, which are plain text.
std::string table(const std::vector<std::string>& titles, const std::string& rows);

/// A row of cells, plain text, that ends with `end`, HTML.
std::string tableRow(const std::vector<std::string>& cells, const std::string& end = "");

/// A cell with a bar as long as `value` is of `largest`.
std::string barCell(double value, double largest);

/// A box with something to notice, plain text; nothing when it is empty.
std::string note(const std::string& text);

}  // namespace palpate
