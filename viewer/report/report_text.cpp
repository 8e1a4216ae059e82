#include "viewer/report/report_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace palpate {
namespace {

constexpr std::size_t shown_nodes = 20, width = 100;

/// Breaks a text at spaces. Its first line begins in column `indent`, which the others are indented
/// to.
std::string wrapped(const std::string& text, std::size_t indent = 0) {
  std::string result, line;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (!line.empty() && indent + line.size() + 1 + word.size() > width) {
      result += line + '\n' + std::string(indent, ' ');
      line.clear();
    }
    line += (line.empty() ? "" : " ") + word;
  }
  return result + line + '\n';
}

std::string header(const Report& report) {
  std::string text;
  for (std::size_t d = 0; d < report.datasets.size(); ++d) {
    const DatasetFacts& facts = report.datasets[d];
    const Dataset& dataset = report.open[d];
    const SpaceTable& space = dataset.spaces().front();
    text += wrapped(
        fmt::format("{}: {} active {}, {} configurations in {} lattice points, ball of {:.4g} mm, "
                    "spacing {:.4g} mm, {}",
                    facts.file.string(), dataset.spaces().size(),
                    dataset.spaces().size() == 1 ? "node" : "nodes", facts.configurations,
                    facts.lattice_points, 1e3 * space.lattice.radius(),
                    1e3 * space.lattice.spacing(), formatBytes(static_cast<double>(facts.bytes))));
  }
  return text + wrapped(describeReferences(report));
}

constexpr const char* frontier_row = "{:<16}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>10}{:>9}{:>8}\n";

std::string frontierRow(const std::string& method, const LatticeMeasures& lattice,
                        const MethodMeasures& measures) {
  const std::string configurations = formatCount(lattice.configurations);
  if (!measures.problem.empty() && measures.all.count == 0)
    return fmt::format("{:<16}{:>7}  ", method, configurations) + wrapped(measures.problem, 25);
  const Spread& error = measures.all.error;
  return fmt::format(frontier_row, method, configurations, formatNumber(error.mean),
                     formatNumber(error.median), formatNumber(error.percentile_95),
                     formatNumber(error.maximum), formatNumber(measures.covered.error.mean),
                     formatShare(measures.all.covered), formatShare(measures.all.within_target),
                     formatNumber(measures.loop_work), formatNumber(measures.nanoseconds, 3));
}

std::string frontier(const Report& report) {
  std::string text = "\n" + fmt::format(frontier_row, "", "", "mean", "median", "95 %", "max",
                                        "mean in", "", "", "loop", "ns per");
  text += fmt::format(frontier_row, "method", "configs", "error", "error", "error", "error",
                      "covered", "covered", "in target", "work", "query");
  for (std::size_t m = 0; m < report.methods.size(); ++m)
    for (std::size_t n = 0; n < report.lattices.size(); ++n)
      text += frontierRow(n == 0 ? report.methods[m] : "", report.lattices[n],
                          report.lattices[n].methods[m]);
  for (const std::string& gap : describeGaps(report)) text += "\n" + wrapped(gap);
  const std::string nodes =
      report.compared == report.nodes.size()
          ? "all active nodes"
          : fmt::format("{} of {} active nodes", report.compared, report.nodes.size());
  text += "\n";
  text += wrapped(fmt::format(
      "Configs: configurations per active node. Errors: |interpolated - exact force| in N, "
      "whole ball, {} together. Covered: the 8 corners around are solved, on one branch. "
      "Loop work: around closed loops, relative to the effort. In target: "
      "error <= max({:.3g} % of |force|, {:.3g} N){}.",
      nodes, 100 * report.target.force_error, report.target.force_floor,
      report.target_of_scene ? ", as the scene asks" : ""));
  return text;
}

std::string nodes(const Report& report) {
  std::vector<const NodeMeasures*> order;
  for (const NodeMeasures& node : report.nodes) order.push_back(&node);
  const auto worst = [](const NodeMeasures* node) {
    const double error = node->methods.front().error.mean;
    return std::isfinite(error) ? error : -1;
  };
  const bool is_cut = order.size() > shown_nodes;
  if (is_cut) {
    std::stable_sort(order.begin(), order.end(),
                     [&](const auto* a, const auto* b) { return worst(a) > worst(b); });
    order.resize(shown_nodes);
  }
  std::string text =
      fmt::format("\n{:<24} {:>10} {:>11} {:>7} {:>8} {:>9} {:>9} {:>9}\n", "active node",
                  "expandable", "terminating", "failed", "force", "mean", "max", "in target");
  for (const NodeMeasures* node : order) {
    const ErrorMeasures& measures = node->methods.front();
    text += fmt::format("{:<24} {:>10} {:>11} {:>7} {:>8} {:>9} {:>9} {:>9}\n", node->name,
                        node->tags[1], node->tags[2], node->tags[3],
                        formatNumber(node->largest_force, 3), formatNumber(measures.error.mean),
                        formatNumber(measures.error.maximum), formatShare(measures.within_target));
  }
  std::string note = fmt::format("Errors of {}", report.methods.front());
  if (report.measured) note += fmt::format(" on {}", report.lattices[*report.measured].label);
  note += ", N; force: the largest of the space, N.";
  if (is_cut)
    note += fmt::format(" The {} worst of {} active nodes.", shown_nodes, report.nodes.size());
  return text + "\n" + wrapped(note);
}

std::string failures(const Report& report) {
  if (report.failures.empty()) return "";
  std::string text =
      fmt::format("\n{:<24} {:>10} {:>11} {:>7}\n", "failed", "points", "attempts", "probes");
  for (const auto& [cause, count] : report.failures)
    text += fmt::format("{:<24} {:>10} {:>11} {:>7}\n", name(cause), count.points, count.attempts,
                        count.probes);
  return text;
}

}  // namespace

std::string describeReferences(const Report& report) {
  switch (report.references) {
    case ReferenceKind::probes:
      return fmt::format(
          "Measured with {} probes: exact solutions, within max_force, "
          "at positions that no interpolation has seen.",
          report.reference_count);
    case ReferenceKind::left_out:
      return fmt::format(
          "There are no solved probes. Measured with {} lattice points that are left out of the "
          "coarser lattices below; of the densest lattice itself nothing can be said.",
          report.reference_count);
    case ReferenceKind::none:
      break;
  }
  return "There are no solved probes, and no coarser lattice inside this one leaves solved "
         "points out: nothing to measure errors with.";
}

std::vector<std::string> describeGaps(const Report& report) {
  std::vector<std::string> gaps;
  for (const LatticeMeasures& lattice : report.lattices)
    for (std::size_t m = 0; m < report.methods.size(); ++m) {
      const MethodMeasures& method = lattice.methods[m];
      if (!method.problem.empty() && method.all.count > 0)
        gaps.push_back(
            fmt::format("{} with {} configurations is not measured on every active node. {}",
                        report.methods[m], formatCount(lattice.configurations), method.problem));
    }
  return gaps;
}

std::string hintForProbes(const Report& report) {
  if (report.references == ReferenceKind::probes) return "";
  return "For errors of this lattice put \"[accuracy] probes = 200\" into the scene and build "
         "again: 200 exact solutions per active node at random positions, "
         "used for nothing but measuring.";
}

std::string formatBytes(double bytes) {
  if (bytes < 1000) return fmt::format("{:.0f} B", bytes);
  for (const char* unit : {"kB", "MB", "GB"}) {
    bytes /= 1000;
    if (bytes < 999.5) return fmt::format("{:.3g} {}", bytes, unit);
  }
  return fmt::format("{:.3g} TB", bytes / 1000);
}

std::string formatNumber(double value, int figures) {
  if (!std::isfinite(value)) return "-";
  const double magnitude = std::abs(value);
  if (value == 0 || (magnitude >= 1e-3 && magnitude < 1e6)) {
    const int digits =
        magnitude == 0 ? 0 : figures - 1 - static_cast<int>(std::floor(std::log10(magnitude)));
    return fmt::format("{:.{}f}", value, std::max(0, digits));
  }
  return fmt::format("{:.{}e}", value, figures - 1);
}

std::string formatCount(double count) {
  const bool is_whole = std::abs(count - std::round(count)) < 1e-6;
  return fmt::format("{:.{}f}", count, is_whole || count >= 100 ? 0 : 1);
}

std::string formatShare(double share) {
  if (!std::isfinite(share)) return "-";
  if (share < 1 && share > 0.9995) return ">99.9 %";
  return fmt::format("{:.1f} %", 100 * share);
}

std::string reportText(const Report& report) {
  std::string text = header(report) + frontier(report) + nodes(report) + failures(report);
  if (const std::string hint = hintForProbes(report); !hint.empty()) text += "\n" + wrapped(hint);
  return text;
}

}  // namespace palpate
