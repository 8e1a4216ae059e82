#include <algorithm>

#include "common/base/number_text.hpp"
#include "common/base/program.hpp"
#include "common/space/failure.hpp"
#include "viewer/report/report_sections.hpp"
#include "viewer/report/report_words.hpp"

namespace palpate {
namespace {

constexpr double smallest_share = 0.01;  ///< of a file; smaller arrays are listed together

std::string sizesTable(const DatasetFacts& facts) {
  const double most = facts.sizes.empty() ? 0 : facts.sizes.front().stored;
  std::string rows;
  std::size_t small = 0;
  double small_bytes = 0;
  for (const auto& [kind, stored, unpacked] : facts.sizes) {
    // A list of thirty small arrays would hide the three that matter.
    if (stored < smallest_share * facts.bytes) {
      ++small;
      small_bytes += stored;
      continue;
    }
    const std::string each = facts.configurations == 0
                                 ? "-"
                                 : formatBytes(static_cast<double>(stored) / facts.configurations);
    rows +=
        tableRow({kind, formatBytes(stored), formatBytes(unpacked), each}, barCell(stored, most));
  }
  if (small > 0)
    rows += tableRow({fmt::format("{} smaller ones", small), formatBytes(small_bytes), "", ""},
                     barCell(small_bytes, most));
  return table({"array", "in the file", "unpacked", "per configuration", ""}, rows);
}

}  // namespace

std::string provenanceList(const Dataset& dataset, const DatasetFacts& facts) {
  std::string html = "<dl>\n";
  const auto row = [&](const char* term, const std::string& text) {
    html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", term, escaped(text));
  };
  row("dataset", facts.file.filename().string());
  row("content hash", dataset.contentId().hex());
  row("build", dataset.buildId().hex());
  row("kernel family", dataset.kernelFamily());
  row("workspace", fmt::format("{}, force limit {:.3g} N", describeBall(dataset),
                               dataset.scene().workspace.max_force));
  row("mesh", describeMesh(dataset.mesh()));
  row("probes",
      fmt::format("{}, {} within max_force, {} beyond it, {} not solved", facts.probes.all,
                  facts.probes.within_force, facts.probes.beyond_force, facts.probes.unsolved()));
  return html + fmt::format(
                    "</dl>\n<details><summary>Scene, with every default written out</summary>"
                    "<pre>{}</pre></details>\n",
                    escaped(dataset.sceneToml()));
}

Section failuresSection(const Report& report) {
  // Bars are relative to the longest.
  std::int64_t most = 0;
  for (const auto& [cause, count] : report.failures) most = std::max(most, count.sum());
  std::string rows;
  for (const auto& [cause, count] : report.failures)
    rows += tableRow({std::string(name(cause)), std::to_string(count.points),
                      std::to_string(count.attempts), std::to_string(count.probes)},
                     barCell(count.sum(), most));
  return {"failures", "Failures",
          "Points are lattice points without a solution, attempts transitions that failed "
          "(another may have reached the point all the same). "
          "palpate explain tells the story of a single point.",
          rows.empty() ? "<p>Nothing failed.</p>\n"
                       : table({"cause", "points", "attempts", "probes", ""}, rows)};
}

Section sizesSection(const Report& report) {
  std::string html;
  for (const DatasetFacts& facts : report.datasets)
    html += fmt::format("<h3>{}: {} for {}</h3>\n", escaped(facts.file.filename().string()),
                        formatBytes(facts.bytes), counted(facts.configurations, "configuration")) +
            sizesTable(facts);
  return {"sizes", "Sizes",
          "What takes the room, all active nodes together, as compressed in the file.", html};
}

Section provenanceSection(const Report& report) {
  std::string html;
  for (std::size_t d = 0; d < report.open.size(); ++d)
    html += provenanceList(report.open[d], report.datasets[d]);
  return {
      "provenance", "Scene and provenance",
      fmt::format("What was computed, and by what. Measured and written by Palpate {}.", version()),
      html};
}

}  // namespace palpate
