#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "common/dataset/dataset.hpp"
#include "common/problem/problem.hpp"
#include "common/space/lattice.hpp"
#include "scheduler/service/coordinator.hpp"
#include "scheduler/state/job_store.hpp"
#include "scheduler/state/journal.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// Everything one scheduler process has of a build: what the verbs `build` and `serve` share.
/// Holding it means holding the lock of the state directory.
class Build {
 public:
  /// Loads the scene's problem, opens or makes the state in `state`, and goes on where the last run
  /// was.
  Build(Problem problem, const std::filesystem::path& state, CoordinatorSettings settings = {});
  Build(const Build&) = delete;
  Build& operator=(const Build&) = delete;

  const Problem& problem() const { return problem_; }
  Coordinator& coordinator() { return coordinator_; }
  const StateDirectory& directory() const { return directory_; }
  /// Results that earlier runs left.
  std::size_t found() const { return coordinator_.found(); }
  /// Writes the dataset of a complete build; returns its tables.
  std::vector<SpaceTable> seal(const std::filesystem::path& file);

 private:
  const Problem problem_;
  const std::string problem_bytes_;
  StateDirectory directory_;
  JobStore store_;
  Journal journal_;
  Coordinator coordinator_;
};

/// True when `file` is the dataset of this build already, false when there is no such file, or when
/// it is that but stores something else (Storage) than asked for. Error (bad input) when it is
/// anything else, unless `force`.
bool isSealed(const std::filesystem::path& file, const Problem& problem, bool force);

}  // namespace palpate
