#include <fmt/format.h>

#include "common/base/number_text.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

/// Of elements; plotStyle() has the classes of the drawings.
constexpr const char* page_style = R"(
:root{--ink:#1b1f24;--soft:#4a535c;--line:#d9dee3;--tint:#f4f6f8;--accent:#0072b2}
*{box-sizing:border-box}
body{margin:0;color:var(--ink);background:#fff;font:16px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,"Helvetica Neue",Arial,sans-serif}
main{max-width:1160px;margin:0 auto;padding:24px 20px 64px}
h1{font-size:1.75rem;line-height:1.2;margin:.2em 0 .1em}
h2{font-size:1.25rem;margin:2.2em 0 .3em;padding-top:.7em;border-top:1px solid var(--line)}
h3{font-size:1rem;margin:1.4em 0 .2em}
p{margin:.4em 0 .8em;max-width:78ch}
.lead,.how{color:var(--soft)}
nav{display:flex;flex-wrap:wrap;gap:2px 16px;margin:1em 0;font-size:.9rem}
a{color:var(--accent)}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(145px,1fr));gap:12px;margin:1.2em 0}
.card{background:var(--tint);border-radius:8px;padding:12px 14px}
.card b{display:block;font-size:1.5rem;line-height:1.25;font-variant-numeric:tabular-nums}
.card span{color:var(--soft);font-size:.85rem;line-height:1.35;display:block}
.figures{display:grid;align-items:end;grid-template-columns:repeat(auto-fit,minmax(min(100%,340px),1fr));gap:18px}
.figures.two{grid-template-columns:repeat(auto-fit,minmax(min(100%,440px),1fr))}
.figures.single{max-width:680px}
.panel>svg{width:100%;height:auto;display:block}
figure{margin:1.2em 0 2em}
figcaption{font-size:.92rem;line-height:1.45;max-width:86ch;margin-top:.5em}
.panel p{display:flex;flex-wrap:wrap;align-items:baseline;gap:0 10px;margin:.1em 0 0;font-size:.85rem}
.panel p b{font-size:.95rem}
.panel a{font-size:.8rem}
.panel a:first-of-type{margin-left:auto}
.swatch{width:14px;height:14px}
.legend{display:flex;flex-wrap:wrap;align-items:center;gap:4px 18px;font-size:.88rem;max-width:none}
.legend span{display:inline-flex;align-items:center;gap:6px}
.scroll{overflow-x:auto;margin:.6em 0 1em;background:linear-gradient(to right,#fff 30%,#fff0) 0 0/40px 100% no-repeat local,linear-gradient(to left,#fff 30%,#fff0) 100% 0/40px 100% no-repeat local,linear-gradient(to right,#0003,#0000) 0 0/12px 100% no-repeat scroll,linear-gradient(to left,#0003,#0000) 100% 0/12px 100% no-repeat scroll}
table{border-collapse:collapse;font-size:.88rem;font-variant-numeric:tabular-nums;min-width:100%}
th,td{padding:4px 8px;text-align:right;white-space:nowrap;border-bottom:1px solid var(--line)}
th{color:var(--soft);font-weight:600;vertical-align:bottom;white-space:normal;line-height:1.25}
th:first-child,td:first-child,.text{text-align:left}
tbody+tbody tr:first-child td{border-top:2px solid var(--line)}
tr.differs td{font-weight:600}
table.words td{white-space:normal}
td.reason{color:var(--soft);white-space:normal;text-align:left}
.bar{display:inline-block;height:.75em;background:var(--accent);border-radius:2px;vertical-align:baseline}
.note{background:#fff7e0;border-left:4px solid #e69f00;padding:10px 14px;max-width:none}
code,pre{font:.85rem/1.45 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace}
pre{background:var(--tint);padding:12px;overflow-x:auto;border-radius:8px}
dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 18px;font-size:.9rem}
dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}
.legend svg .cover{stroke:#8b949e}
@media (max-width:600px){main{padding:16px 12px 48px}table{font-size:.8rem}th,td{padding:3px 5px}pre{white-space:pre-wrap;overflow-wrap:anywhere}dl{grid-template-columns:1fr;gap:0}dd{margin-bottom:.5em}.text .bar{max-width:20vw}}
@media print{main{max-width:none;padding:0}h2{break-after:avoid}figure,table,.panel,.cards{break-inside:avoid}nav,.panel a{display:none}.scroll{overflow:visible}}
)";

}  // namespace

std::string table(const std::vector<std::string>& titles, const std::string& rows) {
  std::string head;
  for (const std::string& title : titles) head += "<th>" + escaped(title) + "</th>";
  return "<div class=\"scroll\"><table><thead><tr>" + head + "</tr></thead>\n<tbody>\n" + rows +
         "</tbody></table></div>\n";
}

std::string tableRow(const std::vector<std::string>& cells, const std::string& end) {
  std::string row = "<tr>";
  for (const std::string& text : cells) row += "<td>" + escaped(text) + "</td>";
  return row + end + "</tr>\n";
}

std::string barCell(double value, double largest) {
  // Nothing to be relative to; written so that NaN ends here too.
  if (!(largest > 0)) return "<td></td>";
  return fmt::format("<td class=\"text\"><span class=\"bar\" style=\"width:{:.0f}px\"></span></td>",
                     160 * value / largest);
}

std::string note(const std::string& text) {
  return text.empty() ? "" : "<p class=\"note\">" + escaped(text) + "</p>\n";
}

std::string reportPage(const Report& report) {
  FigureNumbers numbers(report.open.front().scene().name);
  std::vector<Section> sections;
  if (!report.areas.empty()) sections.push_back(areasSection(report, numbers));
  if (!report.areas_alone) {
    sections.push_back(frontierSection(report, numbers));
    sections.push_back(waysSection(report, numbers));
    sections.push_back(loopsSection(report, numbers));
    sections.push_back(boundsSection(report));
    sections.push_back(nodesSection(report, numbers));
    sections.push_back(organSection(report, numbers));
    sections.push_back(mapsSection(report, numbers));
  }
  sections.push_back(curvesSection(report, numbers));
  for (const auto section : {failuresSection, sizesSection, provenanceSection})
    sections.push_back(section(report));
  const Scene& scene = report.open.front().scene();
  const std::string lead =
      fmt::format("<p class=\"lead\">{}, {}. {}</p>\n", counted(report.nodes.size(), "active node"),
                  escaped(scene.mesh.filename().string()),
                  report.areas_alone ? "" : escaped(describeHeldOut(report)));
  return htmlPage(scene.name + ": how accurate, and how fast",
                  lead + note(hintForProbes(report)) + cards(report), sections);
}

std::string htmlPage(const std::string& heading, const std::string& lead,
                     const std::vector<Section>& sections) {
  // The navigation has what there is, in the same order.
  std::string links, text;
  for (const Section& section : sections) {
    links += fmt::format("<a href=\"#{}\">{}</a>", section.id, section.heading);
    text += fmt::format("<h2 id=\"{}\">{}</h2>\n<p class=\"how\">{}</p>\n{}", section.id,
                        section.heading, section.how, section.content);
  }
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}{2}</style></head>\n<body><main>\n<h1>{0}</h1>\n{3}"
      "<nav>{4}</nav>\n{5}</main></body></html>\n",
      escaped(heading), page_style, plotStyle(), lead, links, text);
}

}  // namespace palpate
