#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "common/dataset/dataset.hpp"
#include "viewer/report/dataset_sizes.hpp"

namespace palpate {

/// What a dataset is made of, over all its active nodes.
struct DatasetFacts {
  std::filesystem::path file;
  std::uintmax_t bytes = 0;
  std::size_t configurations = 0;  ///< solved lattice points
  std::size_t lattice_points = 0;
  std::size_t probes = 0, solved_probes = 0, terminating_probes = 0;
  /// Arrays by group ("points"), those of nodal fields by name, the largest first.
  std::vector<std::pair<std::string, ArraySize>> sizes;
};

/// Reads the sizes from the file. Error when it is not there any more.
DatasetFacts factsOf(const Dataset& dataset);

/// How often a cause made something fail.
struct FailureCount {
  std::int64_t points = 0;    ///< lattice points that stayed without a solution
  std::int64_t attempts = 0;  ///< transitions that failed; another may have reached the point
  std::int64_t probes = 0;

  std::int64_t sum() const { return points + attempts + probes; }
};

/// Only causes that occur.
std::map<Cause, FailureCount> failuresOf(const Dataset& dataset);

/// Error (bad input) unless all are of one scene, but for workspace.spacing and [accuracy].
void refuseOtherScenes(const std::vector<Dataset>& datasets);

}  // namespace palpate
