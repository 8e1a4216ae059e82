#pragma once

#include <map>

#include "common/dataset/dataset.hpp"

namespace palpate {

/// Size of the arrays of one kind in a dataset.
struct ArraySize {
  std::string kind;            ///< group ("mesh"); name of a nodal field ("displacement")
  std::uint64_t stored = 0;    ///< bytes in the file, compressed
  std::uint64_t unpacked = 0;  ///< bytes of the values
};

/// Contents of a dataset, over all its active nodes.
struct DatasetFacts {
  std::filesystem::path file;
  std::uintmax_t bytes = 0;
  std::size_t configurations = 0;  ///< solved lattice points
  std::size_t lattice_points = 0;
  ProbeCounts probes;
  std::vector<ArraySize> sizes;  ///< all arrays, the largest first
};

/// Counts the contents, and reads only the array sizes from the file. Throws Error if the file can
/// no longer be read. One thread at a time (HDF5 is not thread-safe).
DatasetFacts factsOf(const Dataset& dataset);

/// Number of failures by one cause.
struct FailureCount {
  std::int64_t points = 0;    ///< lattice points without a solution
  std::int64_t attempts = 0;  ///< failed transitions; another one may have reached the point
  std::int64_t probes = 0;
};

/// Returns the causes that occur, with their counts.
std::map<Cause, FailureCount> failuresOf(const Dataset& dataset);

/// Returns the differences between the scenes of two datasets in the words of scene files
/// ("material", "workspace.radius"); empty if they are of one scene. workspace.spacing and
/// [accuracy] may differ.
std::vector<std::string> sceneDifferences(const Dataset& a, const Dataset& b);

/// Throws Error (bad input) unless all datasets are of one scene (sceneDifferences).
void refuseOtherScenes(const std::vector<Dataset>& datasets);

}  // namespace palpate
