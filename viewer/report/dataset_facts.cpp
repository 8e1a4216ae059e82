#include "viewer/report/dataset_facts.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
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

/// Callback that HDF5 calls for every object of a file. Adds the size of an array to the sizes of
/// its kind. A negative result stops the iteration.
herr_t addSize(hid_t root, const char* name, const H5O_info_t* info, void* kinds) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const hdf5::Handle array(H5Dopen2(root, name, H5P_DEFAULT), H5Dclose);
  const hdf5::Handle type(H5Dget_type(array.get()), H5Tclose);
  const hdf5::Handle space(H5Dget_space(array.get()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (array.get() < 0 || type.get() < 0 || count < 0) return -1;
  ArraySize& size = (*static_cast<std::map<std::string, ArraySize>*>(kinds))[kindOf(name)];
  size.stored += H5Dget_storage_size(array.get());
  size.unpacked += count * H5Tget_size(type.get());
  return 0;
}

/// Returns the sizes of all kinds of arrays, the largest first.
std::vector<ArraySize> arraySizes(const std::string& file) {
  hdf5::silenceErrorStack();
  // The same properties as in hdf5::Reader. HDF5 requires this if the file is already open.
  const hdf5::Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  hdf5::checked(H5Pset_file_locking(access.get(), false, true), file, "file locking");
  const hdf5::Handle opened(
      hdf5::checked(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.get()), file, "cannot be opened"),
      H5Fclose);
  std::map<std::string, ArraySize> kinds;
  hdf5::checked(
      H5Ovisit2(opened.get(), H5_INDEX_NAME, H5_ITER_INC, addSize, &kinds, H5O_INFO_BASIC), file,
      "its arrays cannot be listed");
  std::vector<ArraySize> sizes;
  for (auto& [kind, size] : kinds) sizes.push_back({kind, size.stored, size.unpacked});
  std::ranges::stable_sort(sizes, std::greater(), &ArraySize::stored);
  return sizes;
}

void countProbes(const std::vector<SpaceTable>& spaces, DatasetFacts& facts) {
  for (const SpaceTable& space : spaces)
    for (const Probe& probe : space.probes) facts.probes.add(probe.record);
}

void countFailedProbes(const std::vector<SpaceTable>& spaces,
                       std::map<Cause, FailureCount>& failures) {
  for (const SpaceTable& space : spaces)
    for (const Probe& probe : space.probes)
      if (probe.record.tag == Tag::failed) ++failures[probe.record.cause].probes;
}

}  // namespace

DatasetFacts factsOf(const Dataset& dataset) {
  DatasetFacts facts;
  facts.file = dataset.file();
  std::error_code ignored;  // a missing file causes the error below, which names the file
  facts.bytes = std::filesystem::file_size(dataset.file(), ignored);
  for (const SpaceTable& space : dataset.spaces()) {
    facts.lattice_points += space.points.size();
    for (const PointRecord& point : space.points) facts.configurations += isSolved(point.tag);
  }
  countProbes(dataset.spaces(), facts);
  countProbes(dataset.probePlaces(), facts);
  PALPATE_ASSERT(facts.configurations <= facts.lattice_points,
                 "each configuration must be at a lattice point");
  facts.sizes = arraySizes(dataset.file().string());
  return facts;
}

std::map<Cause, FailureCount> failuresOf(const Dataset& dataset) {
  std::map<Cause, FailureCount> failures;
  for (const SpaceTable& space : dataset.spaces()) {
    for (const PointRecord& point : space.points)
      if (point.tag == Tag::failed) ++failures[point.cause].points;
    for (const FailedAttempt& attempt : space.attempts) ++failures[attempt.failure.cause].attempts;
  }
  countFailedProbes(dataset.spaces(), failures);
  countFailedProbes(dataset.probePlaces(), failures);
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
    // Comparing each dataset with the first one is enough, because all are shown beside the first.
    if (const std::vector<std::string> what = sceneDifferences(datasets.front(), dataset);
        !what.empty())
      throw badInput(
          "{} and {} have different scenes: they differ in {}. More than two datasets may differ "
          "only in workspace.spacing and [accuracy]; compare others in pairs",
          datasets.front().file().string(), dataset.file().string(), fmt::join(what, ", "));
}

}  // namespace palpate
