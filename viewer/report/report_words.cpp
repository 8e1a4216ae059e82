#include "viewer/report/report_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "common/base/number_text.hpp"

namespace palpate {

std::string describeHeldOut(const Report& report) {
  if (report.held_out.kind == HeldOutKind::probes)
    return fmt::format(
        "Measured with {}: exact solutions within max_force that no interpolation uses.",
        counted(report.held_out.count, "probe"));
  if (report.held_out.kind == HeldOutKind::lattice_points)
    return fmt::format(
        "There are no solved probes. The coarser lattices below are measured at {} that they leave "
        "out; the densest lattice cannot be measured.",
        counted(report.held_out.count, "lattice point"));
  return "Errors cannot be measured: there are no solved probes, and no solved points that a "
         "coarser lattice leaves out.";
}

std::vector<std::string> describeGaps(const Report& report) {
  std::vector<std::string> gaps;
  for (const LatticeMeasures& lattice : report.lattices)
    for (std::size_t m = 0; m < report.methods.size(); ++m) {
      const MethodMeasures& method = lattice.methods[m];
      // If the method has no measurements at all, its row of the table gives the reason.
      if (!method.problem.empty() && method.all.count > 0)
        gaps.push_back(fmt::format(
            "Method {} with {} configurations was not measured on every active node. {}",
            report.methods[m], formatCount(lattice.configurations), method.problem));
    }
  return gaps;
}

std::string hintForProbes(const Report& report) {
  // Areas have hundreds of sites. Computing 200 probes at each site would take longer than
  // everything else, and such probes would not measure the errors between sites.
  if (report.held_out.kind == HeldOutKind::probes || !report.areas.empty()) return "";
  return "To measure errors of this lattice, add \"[accuracy] probes = 200\" to the scene and "
         "build again: 200 exact solutions per active node at random positions, used only for "
         "measuring.";
}

std::string describeProbes(const AreaMeasures& area, const Report& report) {
  const AreaProbes& probes = area.probes;
  const ProbeCounts& counts = probes.counts;
  if (counts.all == 0)
    return "This dataset has no exact solutions between sites: add \"[accuracy] probes = 200\" "
           "to the scene and build again.";
  std::string text = fmt::format(
      "Exact solutions at {}, for displacements that contact reaches: {} within max_force, {} "
      "beyond it, {} not reached from rest.",
      counted(counts.all, "random place"), counts.within_force, counts.beyond_force,
      counts.unsolved());
  if (probes.area.count > 0)
    text += fmt::format(
        " Within max_force, {} meet the target {}; with the nearest site alone, {} do. "
        "The error bound holds at {}; it is {} times the error in the median and {} times at 95 "
        "%.",
        formatShare(probes.area.within_target), describeTarget(report),
        formatShare(probes.nearest_site.within_target), formatShare(probes.area.bound_holds),
        formatNumber(probes.area.bound_over_error.median, 3),
        formatNumber(probes.area.bound_over_error.percentile_95, 3));
  if (probes.unanswered > 0)
    text += fmt::format(" No force is available at {}.", counted(probes.unanswered, "place"));
  if (area.jumps > 0)
    text += fmt::format(" Lattice edges between different branches: {}.", area.jumps);
  return text;
}

std::string describeTarget(const Report& report) {
  return fmt::format("max({:.3g} % of |force|, {:.3g} N){}", 100 * report.target.force_error,
                     report.target.force_floor,
                     report.target_of_scene ? " (set by the scene)" : "");
}

std::string describeMesh(const Mesh& mesh) {
  return fmt::format("{}, {}", counted(mesh.nodes.size(), "node"),
                     counted(mesh.tetrahedra.size(), "tetrahedron", "tetrahedra"));
}

std::string describeBall(const Dataset& dataset) {
  const Lattice& lattice = dataset.spaces().front().lattice;
  return fmt::format("ball of {:.4g} mm, spacing {:.4g} mm", 1e3 * lattice.radius(),
                     1e3 * lattice.spacing());
}

std::string formatBytes(double bytes) {
  if (bytes < 1000) return fmt::format("{:.0f} B", bytes);
  for (const char* unit : {"kB", "MB", "GB"}) {
    bytes /= 1000;
    // With three figures a larger value would become 1e+03.
    if (bytes < 999.5) return fmt::format("{:.3g} {}", bytes, unit);
  }
  return fmt::format("{:.3g} TB", bytes / 1000);
}

std::string formatNumber(double value, int figures) {
  if (!std::isfinite(value)) return "-";
  const double magnitude = std::abs(value);
  // Use fixed notation if it is short. The logarithm counts the digits before the point.
  if (value == 0 || (magnitude >= 1e-3 && magnitude < 1e6)) {
    const int digits =
        magnitude == 0 ? 0 : figures - 1 - static_cast<int>(std::floor(std::log10(magnitude)));
    return fmt::format("{:.{}f}", value, std::max(0, digits));
  }
  return fmt::format("{:.{}e}", value, figures - 1);
}

std::string formatCount(double count) {
  // A mean over active nodes is rarely a whole number.
  const bool is_whole = std::abs(count - std::round(count)) < 1e-6;
  return fmt::format("{:.{}f}", count, is_whole || count >= 100 ? 0 : 1);
}

std::string formatShare(double share) {
  if (!std::isfinite(share)) return "-";
  // "100.0 %" would claim that there is no exception.
  if (share < 1 && share > 0.9995) return ">99.9 %";
  return fmt::format("{:.1f} %", 100 * share);
}

}  // namespace palpate
