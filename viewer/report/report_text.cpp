#include "viewer/report/report_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/number_text.hpp"
#include "common/base/terminal.hpp"
#include "viewer/report/comparison.hpp"
#include "viewer/report/report_words.hpp"
#include "viewer/report/run_accuracy.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_nodes = 20, text_width = 100;

/// Wraps a text that begins in column `indent`, to which the other lines are indented.
std::string wrapped(const std::string& text, std::size_t indent = 0) {
  return palpate::wrapped(std::string(indent, ' ') + text, text_width, indent).substr(indent);
}

std::string header(const Report& report) {
  std::string text;
  for (std::size_t d = 0; d < report.datasets.size(); ++d) {
    const DatasetFacts& facts = report.datasets[d];
    text += wrapped(fmt::format("{}: {}, {} in {}, {}, {}", report.open[d].file().string(),
                                counted(report.nodes.size(), "active node"),
                                counted(facts.configurations, "configuration"),
                                counted(facts.lattice_points, "lattice point"),
                                describeBall(report.open[d]), formatBytes(facts.bytes)));
  }
  return report.areas_alone ? text : text + wrapped(describeHeldOut(report));
}

constexpr const char* frontier_row = "{:<16}{:>7}{:>8}{:>8}{:>8}{:>8}{:>8}{:>8}{:>10}{:>9}{:>8}\n";

std::string frontierLine(const std::string& method, const LatticeMeasures& lattice,
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
    for (const LatticeMeasures& lattice : report.lattices)
      text += frontierLine(&lattice == &report.lattices.front() ? report.methods[m] : "", lattice,
                           lattice.methods[m]);
  for (const std::string& gap : describeGaps(report)) text += "\n" + wrapped(gap);
  const std::string nodes =
      report.compared == report.nodes.size()
          ? "all active nodes"
          : fmt::format("{} of {}", report.compared, counted(report.nodes.size(), "active node"));
  return text + "\n" +
         wrapped(fmt::format(
             "Configs: configurations per active node. Errors: |interpolated - exact force| in "
             "N, in the whole ball, over {}. Covered: all 8 surrounding corners are solved and "
             "on one branch. Loop work: |net work| around circles, divided by the integral of "
             "|force| along them. In target: share of errors <= {}.",
             nodes, describeTarget(report)));
}

std::string nodes(const Report& report) {
  std::vector<std::size_t> listed = worstFirst(report);
  listed.resize(std::min(listed.size(), most_nodes));
  static constexpr const char* row = "{:<24} {:>10} {:>11} {:>7} {:>8} {:>9} {:>9} {:>9}\n";
  std::string text = "\n" + fmt::format(row, "active node", "expandable", "terminating", "failed",
                                        "force", "mean", "max", "in target");
  for (const std::size_t n : listed) {
    const NodeMeasures& node = report.nodes[n];
    const ErrorMeasures& measures = node.methods.front();
    text += fmt::format(row, node.name, node.tags[1], node.tags[2], node.tags[3],
                        formatNumber(node.largest_force, 3), formatNumber(measures.error.mean),
                        formatNumber(measures.error.maximum), formatShare(measures.within_target));
  }
  const std::string cut =
      listed.size() < report.nodes.size()
          ? fmt::format(": {} of {} active nodes", listed.size(), report.nodes.size())
          : "";
  return text + "\n" +
         wrapped(fmt::format(
             "Errors of {} on {}, N, worst first{}. Force: the largest force of the space, N.",
             report.methods.front(), shownLattice(report).label, cut));
}

std::string areas(const Report& report) {
  std::string text;
  for (const AreaMeasures& area : report.areas) {
    static constexpr const char* row = "{:<12} {:>9} {:>7} {:>8} {:>8} {:>8} {:>8}\n";
    const auto columns = [&](const std::string& name, const std::string& force, std::size_t exact,
                             const Spread& error, const Spread& bound) {
      text += fmt::format(row, name, force, exact, formatShare(error.median),
                          formatShare(error.percentile_95), formatShare(bound.median),
                          formatShare(bound.percentile_95));
    };
    text += "\n" + wrapped(fmt::format(
                       "{}: a finger can press anywhere on this surface ({}, {}); prepared in {} "
                       "s, {} ns per query. As shares of the force: errors at exact solutions, "
                       "and error bounds at all places:",
                       area.name, counted(area.sites, "site"),
                       counted(area.collocation_points, "collocation point"),
                       formatNumber(area.seconds_to_prepare), formatNumber(area.nanoseconds, 3)));
    text += fmt::format(row, "displacement", "force, N", "exact", "error", "95 %", "bound", "95 %");
    for (const DepthMeasures& depth : area.depths)
      columns(fmt::format("{:g} mm", 1e3 * depth.depth), formatNumber(depth.force), depth.exact,
              depth.error, depth.bound);
    columns("all", "", area.probes.comparisons.size(), area.probes.error, area.bound);
    text += "\n" + wrapped(describeProbes(area, report));
  }
  return text;
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

constexpr const char* run_row = "{:<24}{:>8}{:>12}{:>12}{:>12}{:>12}{:>15}\n";

std::string runLine(const std::string& label, const ErrorMeasures& errors) {
  return fmt::format(run_row, label, errors.count, formatNumber(100 * errors.relative.median),
                     formatNumber(100 * errors.relative.percentile_95),
                     formatShare(errors.within_target), formatShare(errors.bound_holds),
                     formatNumber(errors.bound_over_error.median));
}

std::string runLines(const char* title, const std::vector<RunInterval>& intervals, double scale) {
  std::string text = fmt::format("{}\n", title);
  for (const auto& [from, to, errors] : intervals)
    text += runLine(std::isfinite(to) ? fmt::format("  {:.3g} to {:.3g}", scale * from, scale * to)
                                      : fmt::format("  {:.3g} and more", scale * from),
                    errors);
  return text;
}

constexpr const char* place_row = "{:<20}{:>9}{:>9}{:>10}{:>10}{:>10}{:>10}{:>9}{:>10}\n";

}  // namespace

std::string textOf(const Report& report) {
  std::string text = header(report) + areas(report);
  if (!report.areas_alone) text += frontier(report) + nodes(report);
  text += failures(report);
  if (const std::string hint = hintForProbes(report); !hint.empty()) text += "\n" + wrapped(hint);
  return text;
}

std::string textOf(const Comparison& comparison) {
  std::string text;
  for (std::size_t s = 0; s < 2; ++s)
    text += fmt::format("{}: {}\n", s == 0 ? 'A' : 'B', comparison.open[s].file().string());
  text += wrapped(fmt::format("The scenes differ in {}. Interpolation method: {}.",
                              fmt::join(comparison.differences, ", "), comparison.method)) +
          "\n";
  for (const auto& [name, first, second] : comparison.properties)
    if (first != second)
      text += fmt::format("{:<24}", name) + wrapped("A: " + first, 24) + std::string(24, ' ') +
              wrapped("B: " + second, 24);
  text += "\n" + fmt::format(place_row, "", "stiffness", "", "mean", "", "|B - A|", "|B - A|", "of",
                             "mean");
  text += fmt::format(place_row, "active node", "A, N/m", "B, N/m", "force A", "force B", "mean",
                      "max", "force A", "bounds");
  for (const ComparedPlace& place : comparison.places) {
    const auto& [a, b] = place.sides;
    text += fmt::format(place_row, place.name, formatNumber(a.stiffness, 3),
                        formatNumber(b.stiffness, 3), formatNumber(a.mean_force, 3),
                        formatNumber(b.mean_force, 3), formatNumber(place.difference.mean),
                        formatNumber(place.difference.maximum), formatShare(place.relative),
                        formatNumber(a.mean_bound + b.mean_bound));
  }
  text += "\n" +
          wrapped(
              "Forces and differences of the force vectors in N, at displacements where both "
              "datasets have forces within the limits of their scenes. Stiffness: at rest, mean "
              "over directions. Bounds: the sum of both error bounds; a smaller difference is not "
              "significant.");
  for (const std::string& limit : comparison.limits) text += "\n" + wrapped(limit);
  return text;
}

std::string textOf(const RunAccuracy& run) {
  std::string text = wrapped(fmt::format(
      "{}: {}, {} of them touch; {} compared with exact solutions of {}{}", run.recording.string(),
      counted(run.ticks, "tick"), run.touching, run.compared.size(), run.scene,
      run.unsolved > 0 ? fmt::format(", {} have none", run.unsolved) : ""));
  if (run.held > 0)
    text += wrapped(fmt::format("{} left out, because a second finger held the body",
                                counted(run.held, "tick")));
  text += "\n" + fmt::format(run_row, "", "ticks", "error, %", "95 %", "in target", "bound holds",
                             "bound / error");
  text += runLine("all", run.all);
  text += runLines("time in the run, s", run.times, 1);
  text += runLines("time in the contact, s", run.in_contact, 1);
  text += runLines("speed of the tool, cm/s", run.speeds, 100);
  return text + "\n" +
         wrapped(fmt::format("Errors: |recorded - exact force| relative to the exact force, or to "
                             "{:g} N if that is larger. In target: share of errors <= max({:.3g} % "
                             "of |force|, {:.3g} N).",
                             relative_error_floor, 100 * run.target.force_error,
                             run.target.force_floor));
}

}  // namespace palpate
