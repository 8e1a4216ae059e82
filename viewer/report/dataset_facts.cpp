#include "viewer/report/dataset_facts.hpp"

#include <algorithm>

#include "common/base/error.hpp"
#include "common/dataset/hdf5_handle.hpp"

namespace palpate {
namespace {

bool haveOnePatches(const Dataset& a, const Dataset& b) {
  return std::ranges::equal(a.spaces(), b.spaces(), [](const SpaceTable& x, const SpaceTable& y) {
    return std::tie(x.patch.name, x.patch.nodes, x.patch.weights) ==
           std::tie(y.patch.name, y.patch.nodes, y.patch.weights);
  });
}

/// Returns the kind of an array: its group ("mesh" for "mesh/nodes"), or the name of a nodal field.
std::string kindOf(const std::string& path) {
  const std::size_t end = path.find('/');
  return path == "points/displacement" || path == "points/pressure" ? path.substr(end + 1)
                                                                    : path.substr(0, end);
}

/// Returns the sizes of all kinds of arrays, the largest first.
std::vector<ArraySize> arraySizes(const Dataset& dataset) {
  std::map<std::string, ArraySize> kinds;
  for (const hdf5::ArrayInfo& array : dataset.arrays()) {
    ArraySize& size = kinds[kindOf(array.path.substr(1))];
    size.stored += array.stored;
    size.unpacked += hdf5::countOf(array.shape) * hdf5::typeOf(array.element).size;
  }
  std::vector<ArraySize> sizes;
  for (auto& [kind, size] : kinds) sizes.push_back({kind, size.stored, size.unpacked});
  std::ranges::stable_sort(sizes, std::greater(), &ArraySize::stored);
  return sizes;
}

template <class Visit>
void forEachProbe(const Dataset& dataset, Visit visit) {
  for (const std::vector<SpaceTable>* spaces : {&dataset.spaces(), &dataset.probePlaces()})
    for (const SpaceTable& space : *spaces)
      for (const Probe& probe : space.probes) visit(probe.record);
}

}  // namespace

DatasetFacts factsOf(const Dataset& dataset) {
  DatasetFacts facts;
  std::error_code error;
  facts.bytes = std::filesystem::file_size(dataset.file(), error);
  if (error) throw failure("{}: {}", dataset.file().string(), error.message());
  for (const SpaceTable& space : dataset.spaces()) {
    facts.lattice_points += space.points.size();
    for (const PointRecord& point : space.points) facts.configurations += isSolved(point.tag);
  }
  forEachProbe(dataset, [&](const PointRecord& probe) { facts.probes.add(probe); });
  facts.sizes = arraySizes(dataset);
  return facts;
}

std::map<Cause, FailureCount> failuresOf(const Dataset& dataset) {
  std::map<Cause, FailureCount> failures;
  for (const SpaceTable& space : dataset.spaces()) {
    for (const PointRecord& point : space.points)
      if (point.tag == Tag::failed) ++failures[point.cause].points;
    for (const FailedAttempt& attempt : space.attempts) ++failures[attempt.failure.cause].attempts;
  }
  forEachProbe(dataset, [&](const PointRecord& probe) {
    if (probe.tag == Tag::failed) ++failures[probe.cause].probes;
  });
  return failures;
}

std::vector<std::string> sceneDifferences(const Dataset& a, const Dataset& b) {
  const Scene &s = a.scene(), &t = b.scene();
  const Workspace &u = s.workspace, &v = t.workspace;
  const std::array<std::pair<bool, const char*>, 9> differences = {
      {{s.regions != t.regions, "material"},
       {!(s.discretization == t.discretization), "discretization"},
       {s.gravity != t.gravity, "gravity"},
       {a.mesh().nodes != b.mesh().nodes || a.mesh().tetrahedra != b.mesh().tetrahedra, "mesh"},
       {a.fixedNodes() != b.fixedNodes(), "fixed nodes"},
       {u.radius != v.radius, "workspace.radius"},
       {u.max_force != v.max_force, "workspace.max_force"},
       {u.reject_inverted != v.reject_inverted, "workspace.reject_inverted"},
       {!haveOnePatches(a, b), "active nodes"}}};
  std::vector<std::string> words;
  for (const auto& [differs, what] : differences)
    if (differs) words.emplace_back(what);
  return words;
}

void refuseOtherScenes(const std::vector<Dataset>& datasets) {
  for (const Dataset& dataset : datasets)
    // Comparing each dataset with the first one is enough: all are then of the scene of the first.
    if (const std::vector<std::string> what = sceneDifferences(datasets.front(), dataset);
        !what.empty())
      throw badInput(
          "{} and {} have different scenes: they differ in {}. More than two datasets may differ "
          "only in workspace.spacing and [accuracy]; compare others in pairs",
          datasets.front().file().string(), dataset.file().string(), fmt::join(what, ", "));
}

}  // namespace palpate
