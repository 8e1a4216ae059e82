#include "scheduler/build_summary.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "scheduler/plan/refinement.hpp"

namespace palpate {
namespace {

constexpr std::size_t most_rows = 24;

struct Row {
  std::string name;
  std::size_t points = 0;
  std::array<std::size_t, 4> count{};  ///< by tag
  std::size_t& of(Tag tag) { return count.at(static_cast<std::size_t>(tag)); }
};

Row rowOf(const SpaceTable& space) {
  Row row{space.patch.name, space.points.size(), {}};
  for (const PointRecord& point : space.points) ++row.of(point.tag);
  return row;
}

std::vector<Row> rowsOf(const std::vector<SpaceTable>& spaces) {
  std::vector<Row> rows;
  for (const SpaceTable& space : spaces) rows.push_back(rowOf(space));
  if (rows.size() <= most_rows) return rows;
  Row sum{fmt::format("all {}", rows.size()), 0, {}};
  for (const Row& row : rows) {
    sum.points += row.points;
    for (std::size_t tag = 0; tag < row.count.size(); ++tag) sum.count[tag] += row.count[tag];
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](Row a, Row b) { return a.of(Tag::failed) > b.of(Tag::failed); });
  std::erase_if(rows, [](Row& row) { return row.of(Tag::failed) == 0; });
  if (rows.size() > most_rows) rows.resize(most_rows);
  rows.push_back(sum);
  return rows;
}

std::string causesOf(const std::vector<SpaceTable>& spaces) {
  std::map<std::string_view, int> causes;
  for (const SpaceTable& space : spaces)
    for (const PointRecord& point : space.points)
      if (point.tag == Tag::failed) ++causes[name(point.cause)];
  std::string text;
  const char* before = "failed: ";
  for (const auto& [cause, count] : causes)
    text += fmt::format("{}{} {}", std::exchange(before, ", "), count, cause);
  return causes.empty() ? text : text + '\n';
}

std::string probesOf(const std::vector<SpaceTable>& spaces) {
  std::size_t probes = 0, solved = 0;
  for (const SpaceTable& space : spaces) {
    probes += space.probes.size();
    for (const Probe& probe : space.probes) solved += isSolved(probe.record.tag) ? 1 : 0;
  }
  return probes == 0 ? "" : fmt::format("probes: {}, {} solved\n", probes, solved);
}

std::string accuracyOf(const std::vector<SpaceTable>& spaces, const Scene& scene) {
  if (!scene.accuracy.adaptive()) return "";
  double worst = 0, kept = 0;
  std::size_t counted = 0, keeping = 0;
  const std::string* worst_name = nullptr;
  for (const SpaceTable& space : spaces) {
    if (!isSolved(space.points.front().tag)) continue;
    const Refinement state = nextRefinement(space, scene);
    ++counted;
    keeping += state.worst_ratio <= 1 ? 1 : 0;
    kept += state.kept;
    if (worst_name == nullptr || state.worst_ratio > worst) worst_name = &space.patch.name;
    worst = std::max(worst, state.worst_ratio);
  }
  if (counted == 0) return "";
  std::string text = fmt::format(
      "accuracy: the estimated error keeps max({:g} %, {:g} N) in {:.4g} % of the workspace",
      100 * scene.accuracy.force_error, scene.accuracy.force_floor,
      100 * kept / static_cast<double>(counted));
  if (keeping < counted)
    text += fmt::format(
        "; {} of {} active node(s) keep it everywhere, "
        "the worst is {} with {:.3g} times the allowed error. "
        "More `levels` help where cells were split that often, "
        "nothing where neighbours lie on different branches",
        keeping, counted, *worst_name, worst);
  return text + '\n';
}

}  // namespace

std::string summaryOf(const std::vector<SpaceTable>& spaces, const Scene& scene) {
  std::string text = fmt::format("{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}\n", "active node",
                                 "points", "expandable", "terminating", "failed", "unknown");
  for (Row& row : rowsOf(spaces))
    text += fmt::format("{:<16} {:>8} {:>10} {:>11} {:>8} {:>8}\n", row.name, row.points,
                        row.of(Tag::expandable), row.of(Tag::terminating), row.of(Tag::failed),
                        row.of(Tag::unknown));
  return text + causesOf(spaces) + probesOf(spaces) + accuracyOf(spaces, scene);
}

ExitCode exitCodeOf(const std::vector<SpaceTable>& spaces) {
  const bool failed = std::any_of(spaces.begin(), spaces.end(), [](const SpaceTable& space) {
    return std::any_of(space.points.begin(), space.points.end(), [](const PointRecord& p) {
      return p.tag == Tag::failed && p.cause != Cause::unreachable;
    });
  });
  return failed ? ExitCode::partly_failed : ExitCode::done;
}

}  // namespace palpate
