#include "viewer/report/report_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/parallel.hpp"
#include "common/base/program.hpp"
#include "common/space/failure.hpp"
#include "viewer/plot/svg_plot.hpp"
#include "viewer/report/field_comparison.hpp"
#include "viewer/report/node_pictures.hpp"
#include "viewer/report/report_text.hpp"

namespace palpate {
namespace {

constexpr std::size_t listed_nodes = 36, plotted_nodes = 12, pictured_nodes = 6;
constexpr double least_loop_work = 1e-10;  ///< drawn; what is below is the error of the sum
constexpr double smallest_share = 0.01;    ///< of a file; smaller arrays are listed together

constexpr const char* style = R"(
:root{--ink:#1b1f24;--soft:#5b6570;--line:#d9dee3;--tint:#f4f6f8;--accent:#0072b2}
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
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(165px,1fr));gap:12px;margin:1.2em 0}
.card{background:var(--tint);border-radius:8px;padding:12px 14px}
.card b{display:block;font-size:1.5rem;line-height:1.25;font-variant-numeric:tabular-nums}
.card span{color:var(--soft);font-size:.85rem;line-height:1.35;display:block}
.figures{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,340px),1fr));gap:18px}
.figures.two{grid-template-columns:repeat(auto-fit,minmax(min(100%,440px),1fr))}
.single{max-width:680px}
.figures>svg,.single>svg,figure svg{width:100%;height:auto;display:block}
figure{margin:0}
figcaption{font-size:.85rem;color:var(--soft);text-align:center}
.legend{display:flex;flex-wrap:wrap;align-items:center;gap:4px 18px;font-size:.88rem;max-width:none}
.legend span{display:inline-flex;align-items:center;gap:6px}
.scroll{overflow-x:auto;margin:.6em 0 1em}
table{border-collapse:collapse;font-size:.88rem;font-variant-numeric:tabular-nums;min-width:100%}
th,td{padding:4px 8px;text-align:right;white-space:nowrap;border-bottom:1px solid var(--line)}
th{color:var(--soft);font-weight:600;vertical-align:bottom;white-space:normal;line-height:1.25}
th:first-child,td:first-child,.text{text-align:left}
tbody tr.first td{border-top:2px solid var(--line)}
td.reason{color:var(--soft);white-space:normal;text-align:left}
.bar{display:inline-block;height:.75em;background:var(--accent);border-radius:2px;vertical-align:baseline}
.note{background:#fff7e0;border-left:4px solid #e69f00;padding:10px 14px;max-width:none}
code,pre{font:.85rem/1.45 ui-monospace,SFMono-Regular,Menlo,Consolas,monospace}
pre{background:var(--tint);padding:12px;overflow-x:auto;border-radius:8px}
dl{display:grid;grid-template-columns:max-content 1fr;gap:4px 18px;font-size:.9rem}
dt{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}
svg text{font-family:inherit;fill:var(--ink)}
svg .title{font-size:13px;font-weight:600}
svg .label{font-size:12px;fill:var(--soft)}
svg .tick{font-size:11.5px;fill:var(--soft)}
svg .grid{stroke:#e7eaee;stroke-width:1}
svg .axis{fill:none;stroke:#8b949e;stroke-width:1}
svg .curve{fill:none;stroke-linejoin:round;stroke-linecap:round}
svg .rim{fill:none;stroke:#8b949e;stroke-width:1}
svg .solved{fill:#fff;stroke:#000;stroke-width:.6;opacity:.75}
svg .terminating{fill:#fff;stroke:#000;stroke-width:1}
svg .failed{fill:none;stroke:#d55e00;stroke-width:2.4}
svg .probe{stroke:#fff;stroke-width:1.6}
svg .cover{fill:none;stroke:#fff;stroke-width:1.2}
svg .jump{fill:none;stroke:#e3120b;stroke-width:2.2}
.legend svg .cover{stroke:#8b949e}
@media print{main{max-width:none;padding:0}h2{break-after:avoid}figure,table,.figures>svg,.cards{break-inside:avoid}nav{display:none}.scroll{overflow:visible}}
)";

std::string section(const char* id, const char* heading, const std::string& how,
                    const std::string& content) {
  return fmt::format("<h2 id=\"{}\">{}</h2>\n<p class=\"how\">{}</p>\n{}", id, heading, how,
                     content);
}

std::string cell(const std::string& text) { return "<td>" + escaped(text) + "</td>"; }

std::string headCells(const std::vector<std::string>& titles) {
  std::string html = "<thead><tr>";
  for (const std::string& title : titles) html += "<th>" + escaped(title) + "</th>";
  return html + "</tr></thead>\n";
}

std::string table(const std::vector<std::string>& titles, const std::string& rows) {
  return "<div class=\"scroll\"><table>" + headCells(titles) + "<tbody>\n" + rows +
         "</tbody></table></div>\n";
}

std::string card(const std::string& value, const std::string& meaning) {
  return fmt::format("<div class=\"card\"><b>{}</b><span>{}</span></div>\n", escaped(value),
                     escaped(meaning));
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

std::string targetText(const Report& report) {
  return fmt::format("max({} of |force|, {:.3g} N)", percent(report.target.force_error),
                     report.target.force_floor);
}

/// The lattice that pictures are made of: the measured one, or the first dataset as it is.
const LatticeMeasures& shownLattice(const Report& report) {
  if (report.measured) return report.lattices[*report.measured];
  return *std::find_if(
      report.lattices.begin(), report.lattices.end(),
      [](const LatticeMeasures& lattice) { return lattice.dataset == 0 && lattice.factor == 0; });
}

std::string cards(const Report& report) {
  const LatticeMeasures& lattice = shownLattice(report);
  const MethodMeasures& method = lattice.methods.front();
  const std::string of = fmt::format(" of {}", report.methods.front());
  std::string html = "<div class=\"cards\">\n";
  html += card(formatNumber(method.all.error.mean) + " N", "mean error" + of + ", whole ball");
  html += card(percent(method.all.relative_to_mean_force), "the same, of the mean force");
  html += card(formatShare(method.all.within_target),
               "of exact solutions within " + targetText(report));
  html += card(formatShare(method.all.covered), "lie in cells whose 8 corners are solved");
  html += card(formatNumber(method.nanoseconds, 3) + " ns",
               "per query" + of + ", on the machine that made this page");
  html += card(formatCount(lattice.configurations), "configurations per active node");
  return html + "</div>\n";
}

// ---- frontier

enum class Abscissa { configurations, nanoseconds };
enum class Ordinate { mean, median, covered_mean };

double valueOf(const MethodMeasures& method, Ordinate ordinate) {
  switch (ordinate) {
    case Ordinate::mean:
      return method.all.error.mean;
    case Ordinate::median:
      return method.all.error.median;
    case Ordinate::covered_mean:
      break;
  }
  return method.covered.error.mean;
}

std::vector<PlotSeries> frontierSeries(const Report& report, Abscissa abscissa, Ordinate ordinate) {
  std::vector<PlotSeries> all;
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    PlotSeries series;
    series.label = report.methods[m];
    series.style = seriesStyle(m);
    for (const LatticeMeasures& lattice : report.lattices) {
      const MethodMeasures& method = lattice.methods[m];
      const double error = valueOf(method, ordinate);
      if (!std::isfinite(error)) continue;
      series.x.push_back(abscissa == Abscissa::configurations ? lattice.configurations
                                                              : method.nanoseconds);
      series.y.push_back(error);
      series.notes.push_back(fmt::format("{}, {} configurations: {} N, {} ns", report.methods[m],
                                         formatCount(lattice.configurations), formatNumber(error),
                                         formatNumber(method.nanoseconds, 3)));
    }
    all.push_back(std::move(series));
  }
  return all;
}

std::string frontierPlot(const Report& report, Abscissa abscissa, Ordinate ordinate) {
  Plot plot;
  static constexpr std::array<const char*, 3> names = {"Whole ball, mean", "Whole ball, median",
                                                       "Covered points, mean"};
  plot.title = std::string(names[static_cast<std::size_t>(ordinate)]) +
               (abscissa == Abscissa::configurations ? ": error against configurations"
                                                     : ": error against time");
  plot.x = {
      abscissa == Abscissa::configurations ? "configurations per active node" : "ns per query",
      true,
      {},
      {}};
  plot.y = {"error of the force, N", true, {}, {}};
  plot.series = frontierSeries(report, abscissa, ordinate);
  return svgOf(plot);
}

std::string latticeTable(const Report& report) {
  std::string rows;
  for (const LatticeMeasures& lattice : report.lattices)
    rows += "<tr>" + cell(lattice.label) + cell(fmt::format("{:.4g}", 1e3 * lattice.spacing)) +
            cell(formatCount(lattice.configurations)) + cell(formatCount(lattice.factorizations)) +
            "</tr>\n";
  return table({"lattice", "spacing, mm", "configurations", "factorizations they took"}, rows);
}

std::string frontierTable(const Report& report) {
  std::string rows;
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    for (std::size_t n = 0; n < report.lattices.size(); ++n) {
      const LatticeMeasures& lattice = report.lattices[n];
      const MethodMeasures& method = lattice.methods[m];
      rows += fmt::format("<tr{}>{}{}", n == 0 ? " class=\"first\"" : "",
                          cell(n == 0 ? report.methods[m] : ""),
                          cell(formatCount(lattice.configurations)));
      if (!method.problem.empty() && method.all.count == 0) {
        rows += fmt::format("<td class=\"reason\" colspan=\"12\">{}</td></tr>\n",
                            escaped(method.problem));
        continue;
      }
      const Spread &error = method.all.error, &covered = method.covered.error;
      for (const std::string& text :
           {formatNumber(error.mean), formatNumber(error.median), formatNumber(error.percentile_95),
            formatNumber(error.maximum), formatNumber(covered.mean), formatNumber(covered.maximum),
            formatShare(method.all.relative.mean), formatShare(method.all.within_target),
            formatShare(method.all.covered), formatNumber(method.loop_work),
            formatNumber(method.nanoseconds, 3), formatNumber(1e3 * method.seconds_to_prepare)})
        rows += cell(text);
      rows += "</tr>\n";
    }
  return table({"method", "configu­rations", "mean", "median", "95 %", "max", "mean, covered",
                "max, covered", "relative", "in target", "covered", "loop work", "ns per query",
                "ms to prepare"},
               rows);
}

std::string frontierSection(const Report& report) {
  const bool any = report.references != ReferenceKind::none;
  std::string html;
  if (any) {
    html += legendOf(frontierSeries(report, Abscissa::configurations, Ordinate::mean));
    html += "<div class=\"figures two\">\n";
    for (const Ordinate ordinate : {Ordinate::mean, Ordinate::median, Ordinate::covered_mean})
      for (const Abscissa abscissa : {Abscissa::configurations, Abscissa::nanoseconds})
        html += frontierPlot(report, abscissa, ordinate);
    html += "</div>\n";
  }
  html += "<h3>In numbers</h3>\n" + frontierTable(report) + latticeTable(report);
  for (const std::string& gap : describeGaps(report))
    html += "<p class=\"note\">" + escaped(gap) + "</p>\n";
  html += fmt::format(
      "<p class=\"how\">Errors are |interpolated &minus; exact force| in newtons. Relative: "
      "divided by the force, or by {} N where that is more. In target: at most {}{}. Covered: "
      "the eight corners around are solved; the same points for every method.</p>\n",
      relative_error_floor, escaped(targetText(report)),
      report.target_of_scene ? ", as the scene asks" : "");
  return section("frontier", "Speed against error",
                 "Lower is more accurate, further left is cheaper; "
                 "a curve below another gives the same accuracy from fewer configurations. "
                 "Each mark is one lattice density.",
                 html);
}

// ---- closed loops

std::string loopsSection(const Report& report) {
  Plot plot;
  plot.title = "Work around closed loops";
  plot.x = {"configurations per active node", true, {}, {}};
  plot.y = {"work / effort", true, {}, {}};
  plot.width = 640;
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    PlotSeries series{.label = report.methods[m], .x = {}, .y = {}, .style = seriesStyle(m)};
    for (const LatticeMeasures& lattice : report.lattices) {
      series.x.push_back(lattice.configurations);
      const double work = lattice.methods[m].loop_work;
      series.y.push_back(std::isfinite(work) ? std::max(work, least_loop_work) : work);
      series.notes.push_back(fmt::format("{}, {} configurations: {}", report.methods[m],
                                         formatCount(lattice.configurations),
                                         formatNumber(lattice.methods[m].loop_work)));
    }
    plot.series.push_back(std::move(series));
  }
  return section("loops", "Closed loops",
                 "Work that a hand gains or loses around circles of a quarter of the workspace "
                 "radius, divided by the force times the way; the largest found. "
                 "Tissue gives back what it took: a method that does not can shake a device. "
                 "10⁻¹⁰ stands for nothing but the error of the sum. "
                 "Where a method gives way to tri-linear interpolation, "
                 "at jumps between branches, its loops leak too.",
                 legendOf(plot.series) + "<div class=\"single\">" + svgOf(plot) + "</div>\n");
}

// ---- error bounds

std::string boundsSection(const Report& report) {
  std::string rows;
  const LatticeMeasures& lattice = shownLattice(report);
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    const ErrorMeasures& measures = lattice.methods[m].all;
    if (measures.bounds == 0) continue;
    rows += "<tr>" + cell(report.methods[m]) + cell(fmt::format("{}", measures.bounds)) +
            cell(formatShare(measures.bound_holds)) +
            cell(formatNumber(measures.bound_over_error)) + "</tr>\n";
  }
  const std::string content =
      rows.empty()
          ? "<p>No method gave bounds here.</p>\n"
          : table({"method", "bounds given", "error within bound", "bound / error, median"}, rows);
  return section("bounds", "Error bounds",
                 "Methods say themselves how wrong they may be. "
                 "A good bound holds almost always and is not many times the error.",
                 content);
}

// ---- active nodes

std::vector<const NodeMeasures*> worstFirst(const Report& report) {
  std::vector<const NodeMeasures*> nodes;
  for (const NodeMeasures& node : report.nodes) nodes.push_back(&node);
  const auto error = [](const NodeMeasures* node) {
    return node->methods.front().count == 0 ? -1 : node->methods.front().error.mean;
  };
  std::stable_sort(nodes.begin(), nodes.end(), [&](const NodeMeasures* a, const NodeMeasures* b) {
    return error(a) > error(b);
  });
  return nodes;
}

/// Error against configurations of one active node that was compared; `place` is its row in
/// node_errors.
std::string nodePlot(const Report& report, const std::string& node, std::size_t place) {
  Plot plot;
  plot.title = node;
  plot.x = {"configurations", true, {}, {}};
  plot.y = {"mean error, N", true, {}, {}};
  plot.width = 380;
  plot.height = 280;
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    PlotSeries series{.label = report.methods[m], .x = {}, .y = {}, .style = seriesStyle(m)};
    for (const LatticeMeasures& lattice : report.lattices) {
      if (lattice.node_errors.empty()) continue;
      series.x.push_back(static_cast<double>(lattice.node_configurations[place]));
      series.y.push_back(lattice.node_errors[place][m]);
    }
    plot.series.push_back(std::move(series));
  }
  return svgOf(plot);
}

std::string nodePlots(const Report& report) {
  if (!report.measured || report.nodes.size() < 2) return "";
  std::vector<std::pair<double, std::string>> plots;  // by error
  std::size_t place = 0;
  for (const NodeMeasures& node : report.nodes)
    if (node.compared) {
      plots.emplace_back(-node.methods.front().error.mean, nodePlot(report, node.name, place));
      ++place;
    }
  std::stable_sort(plots.begin(), plots.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  if (plots.size() > plotted_nodes) plots.resize(plotted_nodes);
  std::string html = legendOf(frontierSeries(report, Abscissa::configurations, Ordinate::mean)) +
                     "<div class=\"figures\">\n";
  for (const auto& [error, plot] : plots) html += plot;
  return html + "</div>\n";
}

std::string nodesTable(const std::vector<const NodeMeasures*>& nodes) {
  std::string rows;
  for (const NodeMeasures* node : nodes) {
    const ErrorMeasures& measures = node->methods.front();
    rows += "<tr>" + cell(node->name);
    for (const Tag tag : {Tag::expandable, Tag::terminating, Tag::failed})
      rows += cell(fmt::format("{}", node->tags[static_cast<std::size_t>(tag)]));
    for (const std::string& text :
         {fmt::format("{}", node->jumps), formatNumber(node->largest_force, 3),
          fmt::format("{}", node->references), formatNumber(measures.error.mean),
          formatNumber(measures.error.median), formatNumber(measures.error.percentile_95),
          formatNumber(measures.error.maximum), formatShare(measures.within_target),
          formatShare(measures.bound_holds)})
      rows += cell(text);
    rows += "</tr>\n";
  }
  return table({"active node", "expandable", "terminating", "failed", "jumps", "largest force, N",
                "exact solutions", "mean", "median", "95 %", "max", "in target", "within bound"},
               rows);
}

/// Mean errors, a column per method.
std::string nodeMethodsTable(const Report& report, const std::vector<const NodeMeasures*>& nodes) {
  std::vector<std::string> titles = {"mean error, N"};
  titles.insert(titles.end(), report.methods.begin(), report.methods.end());
  std::string rows;
  for (const NodeMeasures* node : nodes) {
    if (!node->compared) continue;
    rows += "<tr>" + cell(node->name);
    for (const ErrorMeasures& method : node->methods) rows += cell(formatNumber(method.error.mean));
    rows += "</tr>\n";
  }
  return rows.empty() || report.methods.size() < 2 ? "" : table(titles, rows);
}

std::string nodesSection(const Report& report) {
  const std::vector<const NodeMeasures*> all = worstFirst(report);
  const std::vector<const NodeMeasures*> listed(
      all.begin(), all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), listed_nodes)));
  std::string how = fmt::format("Errors of {} in newtons on {}, the worst first",
                                report.methods.front(), escaped(shownLattice(report).label));
  how += listed.size() < all.size()
             ? fmt::format(": {} of {} active nodes.", listed.size(), all.size())
             : ".";
  how +=
      " Jumps: edges of the lattice between different branches of solutions, "
      "across which nothing is interpolated smoothly.";
  if (report.compared < all.size())
    how += fmt::format(" The other methods were compared on {} nodes, evenly chosen.",
                       report.compared);
  return section("nodes", "Active nodes", how,
                 nodesTable(listed) + nodeMethodsTable(report, all) + nodePlots(report));
}

// ---- pictures

/// In the order of the methods, without their marks.
std::string curveLegend(const Report& report, const Plot& plot) {
  std::vector<PlotSeries> series = {plot.series.front()};
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    series.push_back(
        {.label = report.methods[m], .x = {}, .y = {}, .style = seriesStyle(m), .marks = false});
  return legendOf(series);
}

std::string picturesSection(const Report& report) {
  std::vector<const NodeMeasures*> nodes = worstFirst(report);
  const bool is_cut = nodes.size() > pictured_nodes;
  if (is_cut) nodes.resize(pictured_nodes);
  std::vector<NodePictures> pictures(nodes.size());
  inParallel(nodes.size(), [&](std::size_t n) {
    pictures[n] = takePictures(report, shownLattice(report), nodes[n]->space);
  });
  std::vector<double> values;
  for (const NodePictures& node : pictures)
    for (const SliceMap& slice : node.slices) {
      values.insert(values.end(), slice.bound.begin(), slice.bound.end());
      for (const MeasuredReference& reference : slice.references) values.push_back(reference.error);
    }
  const ColourScale scale(values);
  const std::string which =
      is_cut ? fmt::format(" The {} active nodes with the largest errors.", pictured_nodes) : "";

  std::string maps = legendOf(scale), curves;
  static constexpr std::array<const char*, 3> planes = {
      "x and y, through rest", "x and z, through rest", "y and z, through rest"};
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    maps += fmt::format("<h3>{}</h3>\n<div class=\"figures\">\n", escaped(nodes[n]->name));
    for (std::size_t s = 0; s < planes.size(); ++s)
      maps += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                          svgOf(pictures[n].slices[s], scale), planes[s]);
    maps += "</div>\n";
    if (n == 0) curves += curveLegend(report, pictures[n].curves.front());
    curves += fmt::format("<h3>{}</h3>\n<div class=\"figures\">\n", escaped(nodes[n]->name));
    for (const Plot& plot : pictures[n].curves) curves += svgOf(plot);
    curves += "</div>\n";
  }
  return section(
             "maps", "Where the error is",
             fmt::format("Colour: the error bound that {} gives at each displacement in three "
                         "planes through the rest position (axes in mm, lattice of {}). "
                         "A dot lighter than its surroundings is a bound that did not hold. White: "
                         "no bound.{}",
                         report.methods.front(), escaped(shownLattice(report).label), which),
             maps) +
         section("curves", "Force along the axes",
                 "The force of the tissue on the tool along the direction of motion, "
                 "for displacements along x, y and z. Marks are exact solutions of the lattice; "
                 "where curves part between marks, methods disagree." +
                     which,
                 curves);
}

// ---- failures, sizes, provenance

std::string bar(double value, double largest) {
  return largest > 0
             ? fmt::format(
                   "<td class=\"text\"><span class=\"bar\" style=\"width:{:.0f}px\"></span></td>",
                   160 * value / largest)
             : "<td></td>";
}

std::string failuresSection(const Report& report) {
  std::string content = "<p>Nothing failed.</p>\n", rows;
  std::int64_t most = 0;
  for (const auto& [cause, count] : report.failures)
    most = std::max(most, count.attempts + count.points + count.probes);
  for (const auto& [cause, count] : report.failures)
    rows += "<tr>" + cell(std::string(name(cause))) + cell(fmt::format("{}", count.points)) +
            cell(fmt::format("{}", count.attempts)) + cell(fmt::format("{}", count.probes)) +
            bar(static_cast<double>(count.attempts + count.points + count.probes),
                static_cast<double>(most)) +
            "</tr>\n";
  if (!rows.empty()) content = table({"cause", "points", "attempts", "probes", ""}, rows);
  return section(
      "failures", "Failures",
      "Points are lattice points without a solution, "
      "attempts transitions that failed (another may have reached the point all the same). "
      "palpate explain tells the story of a single point.",
      content);
}

std::string sizesSection(const Report& report) {
  std::string html;
  for (const DatasetFacts& facts : report.datasets) {
    std::string rows;
    double most = 0;
    for (const auto& [kind, size] : facts.sizes)
      most = std::max(most, static_cast<double>(size.stored));
    std::size_t small = 0;
    double small_bytes = 0;
    for (const auto& [kind, size] : facts.sizes) {
      const auto stored = static_cast<double>(size.stored);
      if (stored < smallest_share * static_cast<double>(facts.bytes)) {
        ++small;
        small_bytes += stored;
        continue;
      }
      rows += "<tr>" + cell(kind) + cell(formatBytes(stored)) +
              cell(formatBytes(static_cast<double>(size.unpacked))) +
              cell(facts.configurations == 0
                       ? "-"
                       : formatBytes(stored / static_cast<double>(facts.configurations))) +
              bar(stored, most) + "</tr>\n";
    }
    if (small > 0)
      rows += "<tr>" + cell(fmt::format("{} smaller ones", small)) +
              cell(formatBytes(small_bytes)) + "<td></td><td></td>" + bar(small_bytes, most) +
              "</tr>\n";
    html += fmt::format("<h3>{}: {} for {} configurations</h3>\n",
                        escaped(facts.file.filename().string()),
                        formatBytes(static_cast<double>(facts.bytes)), facts.configurations);
    html += table({"array", "in the file", "unpacked", "per configuration", ""}, rows);
  }
  return section("sizes", "Sizes",
                 "What takes the room, all active nodes together, as compressed in the file.",
                 html);
}

std::string provenanceSection(const Report& report) {
  std::string html;
  for (std::size_t d = 0; d < report.open.size(); ++d) {
    const Dataset& dataset = report.open[d];
    const DatasetFacts& facts = report.datasets[d];
    const SpaceTable& space = dataset.spaces().front();
    html += "<dl>\n";
    const auto row = [&](const char* term, const std::string& text) {
      html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", term, escaped(text));
    };
    row("dataset", facts.file.filename().string());
    row("content hash", dataset.contentId().hex());
    row("build", dataset.buildId().hex());
    row("kernel family", dataset.kernelFamily());
    row("workspace", fmt::format("ball of {:.4g} mm, spacing {:.4g} mm, force limit {:.3g} N",
                                 1e3 * space.lattice.radius(), 1e3 * space.lattice.spacing(),
                                 dataset.scene().workspace.max_force));
    row("mesh", fmt::format("{} nodes, {} tetrahedra", dataset.mesh().nodes.size(),
                            dataset.mesh().tetrahedra.size()));
    row("probes", fmt::format("{}, {} of them solved, {} beyond max_force and not measured with",
                              facts.probes, facts.solved_probes, facts.terminating_probes));
    html += "</dl>\n";
    html += fmt::format(
        "<details><summary>Scene, with every default written "
        "out</summary><pre>{}</pre></details>\n",
        escaped(dataset.sceneToml()));
  }
  return section(
      "provenance", "Scene and provenance",
      fmt::format("What was computed, and by what. Measured and written by Palpate {}.", version()),
      html);
}

}  // namespace

std::string reportPage(const Report& report) {
  const std::string& scene = report.open.front().scene().name;
  std::string html = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>{0}: speed against error</title>\n<style>{1}</style></head>\n<body><main>\n"
      "<h1>{0}: how accurate, and how fast</h1>\n<p class=\"lead\">{2} active {3}, {4}. {5}</p>\n",
      escaped(scene), style, report.nodes.size(), report.nodes.size() == 1 ? "node" : "nodes",
      escaped(report.open.front().scene().mesh.filename().string()),
      escaped(describeReferences(report)));
  if (const std::string hint = hintForProbes(report); !hint.empty())
    html += "<p class=\"note\">" + escaped(hint) + "</p>\n";
  html += cards(report);
  html +=
      R"(<nav><a href="#frontier">Speed against error</a><a href="#loops">Closed loops</a><a href="#bounds">Error bounds</a><a href="#nodes">Active nodes</a>)"
      R"(<a href="#maps">Where the error is</a><a href="#curves">Force along the axes</a><a href="#failures">Failures</a>)"
      R"(<a href="#sizes">Sizes</a><a href="#provenance">Scene and provenance</a></nav>)"
      "\n";
  html += frontierSection(report) + loopsSection(report) + boundsSection(report) +
          nodesSection(report) + picturesSection(report) + failuresSection(report) +
          sizesSection(report) + provenanceSection(report);
  return html + "</main></body></html>\n";
}

}  // namespace palpate
