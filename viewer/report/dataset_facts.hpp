#pragma once

#include <map>

#include "common/dataset/dataset.hpp"

namespace palpate {

/// The room that arrays of one kind take in a dataset.
struct ArraySize {
  std::string kind;            ///< their group, "mesh"; of nodal fields their name, "displacement"
  std::uint64_t stored = 0;    ///< bytes in the file, compressed
  std::uint64_t unpacked = 0;  ///< bytes of their values
};

/// What a dataset is made of, over all its active nodes.
struct DatasetFacts {
  std::filesystem::path file;
  std::uintmax_t bytes = 0;
  std::size_t configurations = 0;  ///< solved lattice points
  std::size_t lattice_points = 0;
  ProbeCounts probes;
  std::vector<ArraySize> sizes;  ///< of all arrays together, the largest first
};

/// Reads the sizes from the file; nothing else of it is looked at. Error when it cannot be read any
/// more. One thread at a time (HDF5 is not thread-safe).
DatasetFacts factsOf(const Dataset& dataset);

/// How often a cause made something fail.
struct FailureCount {
  std::int64_t points = 0;    ///< lattice points that stayed without a solution
  std::int64_t attempts = 0;  ///< transitions that failed; another may have reached the point
  std::int64_t probes = 0;
};

/// Only causes that occur.
std::map<Cause, FailureCount> failuresOf(const Dataset& dataset);

/// In what two datasets are not of one scene, in the words of scene files: "material",
/// "workspace.radius"; empty when they are. workspace.spacing and [accuracy] may differ.
std::vector<std::string> sceneDifferences(const Dataset& a, const Dataset& b);

/// Error (bad input) unless all are of one scene (sceneDifferences).
void refuseOtherScenes(const std::vector<Dataset>& datasets);

}  // namespace palpate
