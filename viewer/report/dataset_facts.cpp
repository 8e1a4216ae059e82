#include "viewer/report/dataset_facts.hpp"

#include <algorithm>

#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Why the datasets are not of one scene; empty when they are.
std::string differenceOf(const Dataset& a, const Dataset& b) {
  const Scene &s = a.scene(), &t = b.scene();
  if (s.regions != t.regions) return "material";
  if (!(s.discretization == t.discretization)) return "discretization";
  if (s.gravity != t.gravity) return "gravity";
  if (a.mesh().nodes != b.mesh().nodes || a.mesh().tetrahedra != b.mesh().tetrahedra) return "mesh";
  if (a.fixedNodes() != b.fixedNodes()) return "fixed nodes";
  if (s.workspace.radius != t.workspace.radius) return "workspace.radius";
  if (s.workspace.max_force != t.workspace.max_force) return "workspace.max_force";
  if (s.workspace.reject_inverted != t.workspace.reject_inverted)
    return "workspace.reject_inverted";
  const auto same_patch = [](const SpaceTable& x, const SpaceTable& y) {
    return x.patch.name == y.patch.name && x.patch.nodes == y.patch.nodes &&
           x.patch.weights == y.patch.weights;
  };
  if (!std::equal(a.spaces().begin(), a.spaces().end(), b.spaces().begin(), b.spaces().end(),
                  same_patch))
    return "active nodes";
  return "";
}

/// "mesh", "points", "displacement": the group of an array, or itself where it is of nodal fields.
std::string kindOf(const std::string& path) {
  for (const char* field : {"displacement", "pressure"})
    if (path == std::string("/points/") + field) return field;
  return path.substr(1, std::min(path.find('/', 1), path.size()) - 1);
}

}  // namespace

DatasetFacts factsOf(const Dataset& dataset) {
  DatasetFacts facts;
  facts.file = dataset.file();
  std::error_code ignored;
  facts.bytes = std::filesystem::file_size(dataset.file(), ignored);
  for (const SpaceTable& space : dataset.spaces()) {
    facts.lattice_points += space.points.size();
    facts.probes += space.probes.size();
    for (const PointRecord& point : space.points)
      facts.configurations += isSolved(point.tag) ? 1 : 0;
    for (const Probe& probe : space.probes) {
      facts.solved_probes += isSolved(probe.record.tag) ? 1 : 0;
      facts.terminating_probes += probe.record.tag == Tag::terminating ? 1 : 0;
    }
  }
  std::map<std::string, ArraySize> kinds;
  for (const ArraySize& array : arraySizes(dataset.file())) {
    ArraySize& kind = kinds[kindOf(array.path)];
    kind.stored += array.stored;
    kind.unpacked += array.unpacked;
  }
  facts.sizes.assign(kinds.begin(), kinds.end());
  std::stable_sort(facts.sizes.begin(), facts.sizes.end(),
                   [](const auto& a, const auto& b) { return a.second.stored > b.second.stored; });
  return facts;
}

std::map<Cause, FailureCount> failuresOf(const Dataset& dataset) {
  std::map<Cause, FailureCount> failures;
  for (const SpaceTable& space : dataset.spaces()) {
    for (const PointRecord& point : space.points)
      if (point.tag == Tag::failed) ++failures[point.cause].points;
    for (const FailedAttempt& attempt : space.attempts) ++failures[attempt.failure.cause].attempts;
    for (const Probe& probe : space.probes)
      if (probe.record.tag == Tag::failed) ++failures[probe.record.cause].probes;
  }
  return failures;
}

void refuseOtherScenes(const std::vector<Dataset>& datasets) {
  for (const Dataset& dataset : datasets)
    if (const std::string what = differenceOf(datasets.front(), dataset); !what.empty())
      throw badInput(
          "{} and {} are not of one scene: they differ in {}. "
          "Only workspace.spacing and [accuracy] may differ",
          datasets.front().file().string(), dataset.file().string(), what);
}

}  // namespace palpate
