#include "scheduler/build_summary.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "scheduler/plan/refinement.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/status_text.hpp"

namespace palpate {
namespace {

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
    // Nothing can be refined around an origin that failed, and nothing estimated.
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
  std::vector<wire::SpaceStatus> rows;
  std::map<std::string, std::int32_t> causes;
  for (const SpaceTable& space : spaces) {
    wire::SpaceStatus& row = rows.emplace_back();
    row.set_name(space.patch.name);
    row.set_stage(std::string(name(Stage::complete)));
    for (const PointRecord& point : space.points) {
      addPoint(row, point.tag);
      if (point.tag == Tag::failed) ++causes[std::string(name(point.cause))];
    }
  }
  return pointTable(std::move(rows), false) + causesLine("failed", causes) + probesOf(spaces) +
         accuracyOf(spaces, scene);
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
