#pragma once

#include <string>
#include <vector>

#include "viewer/plot/svg_plot.hpp"

// Numbered figures of a page, each of which can be taken along: as SVG files, and its numbers as
// CSV. The files are in the page itself (data: addresses), so that it needs neither script nor
// network.

namespace palpate {

/// A file that a panel offers beside its drawing.
struct PanelData {
  std::string label;   ///< of the link: "CSV"
  std::string ending;  ///< of the file's name: ".csv", "-points.csv"
  std::string text;
};

/// One drawing of a figure.
struct Panel {
  std::string svg;        ///< an <svg> element whose viewBox begins at 0 0
  std::string caption{};  ///< a few words under it, plain text; may be empty
  SvgPart key{};          ///< what a file needs below it, where the page has a key of its own
  std::vector<PanelData> data{};
};

/// Panels under one number and caption.
struct Figure {
  std::string key{};    ///< HTML above the panels; may be empty
  std::string caption;  ///< HTML: what is seen, in which units, where the numbers come from
  std::vector<Panel> panels{};
  const char* layout = "";  ///< CSS class: "two" panels side by side, "single"; else about three
};

/// Numbers the figures of one page, in the order in which it is asked for them.
class FigureNumbers {
 public:
  /// name: what the names of files begin with, any text.
  explicit FigureNumbers(const std::string& name);

  /// The figure as HTML, under the next number. Panels are lettered where there are several.
  std::string html(const Figure& figure);
  int count() const { return count_; }

 private:
  std::string stem_;
  int count_ = 0;
};

/// A plot with its legend and its numbers (csvOf).
Panel panelOf(const Plot& plot, const std::string& caption = "");

/// An <svg> element as a file of its own: with its styles, on white, `key` below it.
std::string svgFile(const std::string& svg, const SvgPart& key);

/// An address that holds `text` itself.
std::string dataAddress(const std::string& media_type, const std::string& text);

/// CSS of the classes that the drawings use.
const char* plotStyle();

}  // namespace palpate
