#pragma once

#include <map>

#include "common/dataset/dataset.hpp"

namespace palpate {

/// Total size of the arrays of one kind in a dataset.
struct ArraySize {
  std::string kind;            ///< a group such as "mesh", or a nodal field such as "displacement"
  std::uint64_t stored = 0;    ///< bytes in the file, compressed
  std::uint64_t unpacked = 0;  ///< bytes of the uncompressed values
};

/// Facts about the contents of a dataset, summed over all its active nodes.
struct DatasetFacts {
  std::uintmax_t bytes = 0;
  std::size_t configurations = 0;  ///< solved lattice points
  std::size_t lattice_points = 0;
  ProbeCounts probes;
  std::vector<ArraySize> sizes;  ///< of all arrays, the largest first
};

/// Returns the facts of an open dataset. Throws Error if the file no longer exists.
DatasetFacts factsOf(const Dataset& dataset);

/// Number of failures with one cause.
struct FailureCount {
  std::int64_t points = 0;    ///< lattice points without a solution
  std::int64_t attempts = 0;  ///< failed transitions; a later transition may have reached the point
  std::int64_t probes = 0;
};

std::map<Cause, FailureCount> failuresOf(const Dataset& dataset);

/// Returns the differences between the scenes of two datasets, as keys of scene files ("material",
/// "workspace.radius"). Returns an empty list if both are of one scene. Differences in
/// workspace.spacing and [accuracy] are ignored.
std::vector<std::string> sceneDifferences(const Dataset& a, const Dataset& b);

/// Throws Error (bad input) unless all datasets are of one scene (sceneDifferences).
void refuseOtherScenes(const std::vector<Dataset>& datasets);

}  // namespace palpate
