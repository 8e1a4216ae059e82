#include "viewer/plot/figure.hpp"

#include <fmt/format.h>

#include <cctype>

#include "common/base/assertion.hpp"
#include "viewer/plot/csv.hpp"

namespace palpate {
namespace {

/// As part of a file's name on every system.
std::string fileStem(const std::string& name) {
  std::string stem;
  for (const unsigned char c : name) {
    const bool is_plain = c < 128 && (std::isalnum(c) != 0 || c == '-' || c == '_');
    if (is_plain)
      stem += static_cast<char>(c);
    else if (!stem.empty() && stem.back() != '-')
      stem += '-';
  }
  while (!stem.empty() && stem.back() == '-') stem.pop_back();
  return stem.empty() ? "palpate" : stem;
}

std::string linkTo(const std::string& label, const std::string& file, const char* media_type,
                   const std::string& text) {
  return fmt::format("<a download=\"{0}\" title=\"Save {0}\" href=\"{1}\">{2}</a>", escaped(file),
                     dataAddress(media_type, text), escaped(label));
}

/// A drawing, and below it its letter, its words and what can be taken along.
std::string panelHtml(const Panel& panel, const std::string& letter, const std::string& file) {
  std::string html = "<div class=\"panel\">" + panel.svg + "<p>";
  if (!letter.empty()) html += "<b>" + letter + "</b> ";
  if (!panel.caption.empty()) html += "<span>" + escaped(panel.caption) + "</span> ";
  html += linkTo("SVG", file + ".svg", "image/svg+xml", svgFile(panel.svg, panel.key));
  for (const PanelData& data : panel.data)
    html += ' ' + linkTo(data.label, file + data.ending, "text/csv", data.text);
  return html + "</p></div>\n";
}

}  // namespace

FigureNumbers::FigureNumbers(const std::string& name) : stem_(fileStem(name)) {}

std::string FigureNumbers::html(const Figure& figure) {
  ++count_;
  std::string panels;
  for (std::size_t n = 0; n < figure.panels.size(); ++n) {
    // Beyond z nobody would count on.
    PALPATE_ASSERT(n < 26, "a figure has no more panels than there are letters");
    const std::string letter =
        figure.panels.size() > 1 ? std::string(1, static_cast<char>('a' + n)) : "";
    panels +=
        panelHtml(figure.panels[n], letter, fmt::format("{}-figure-{}{}", stem_, count_, letter));
  }
  return fmt::format(
      "<figure id=\"figure-{0}\">{1}<div class=\"figures {2}\">\n{3}</div>\n"
      "<figcaption><b>Figure {0}.</b> {4}</figcaption></figure>\n",
      count_, figure.key, figure.layout, panels, figure.caption);
}

Panel panelOf(const Plot& plot, const std::string& caption) {
  return {.svg = svgOf(plot),
          .caption = caption,
          .key = legendPart(plot.series, plot.width),
          .data = {{"CSV", ".csv", csvOf(plot)}}};
}

std::string svgFile(const std::string& svg, const SvgPart& key) {
  const std::string begin = "viewBox=\"0 0 ";
  const std::size_t box = svg.find(begin), open = svg.find('>');
  PALPATE_ASSERT(svg.starts_with("<svg ") && box < open, "a drawing is an <svg> with a viewBox");
  std::size_t digits = 0;
  const std::string sizes = svg.substr(box + begin.size());
  const double width = std::stod(sizes, &digits), height = std::stod(sizes.substr(digits));
  const double whole = height + key.height;
  const std::string inner = svg.substr(open + 1, svg.rfind("</svg>") - open - 1);
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
      "height=\"{1:g}\">\n<style>svg{{font-family:sans-serif}}{2}</style>\n"
      "<rect width=\"{0:g}\" height=\"{1:g}\" fill=\"#fff\"/>{3}"
      "<g transform=\"translate(0 {4:g})\">{5}</g>\n</svg>\n",
      width, whole, plotStyle(), inner, height, key.svg);
}

std::string dataAddress(const std::string& media_type, const std::string& text) {
  // What a quoted attribute and an address both take as it is.
  constexpr std::string_view plain = " ,.;/=()!*-_+";
  std::string address = "data:" + media_type + ";charset=utf-8,";
  for (const unsigned char c : text) {
    const bool is_plain =
        c < 128 && (std::isalnum(c) != 0 || plain.find(static_cast<char>(c)) < plain.size());
    if (is_plain)
      address += static_cast<char>(c);
    else
      address += fmt::format("%{:02X}", c);
  }
  return address;
}

const char* plotStyle() {
  return R"(
svg text{font-family:inherit;fill:#1b1f24}
svg .title{font-size:13px;font-weight:600}
svg .label{font-size:12px;fill:#3d454d}
svg .tick{font-size:11.5px;fill:#3d454d}
svg .grid{stroke:#e7eaee;stroke-width:1}
svg .axis{fill:none;stroke:#8b949e;stroke-width:1}
svg .curve{fill:none;stroke-linejoin:round;stroke-linecap:round}
svg .fixed{fill:none;stroke:#1b1f24;stroke-width:1.1}
svg .bar{fill:none;stroke:#1b1f24;stroke-width:1.4}
svg .rim{fill:none;stroke:#8b949e;stroke-width:1}
svg .solved{fill:#fff;stroke:#000;stroke-width:.6;opacity:.75}
svg .terminating{fill:#fff;stroke:#000;stroke-width:1}
svg .failed{fill:none;stroke:#d55e00;stroke-width:2.4}
svg .probe{stroke:#fff;stroke-width:1.6}
svg .cover{fill:none;stroke:#fff;stroke-width:1.2}
svg .jump{fill:none;stroke:#e3120b;stroke-width:2.2}
)";
}

}  // namespace palpate
