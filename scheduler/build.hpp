#pragma once

#include "common/base/program.hpp"
#include "common/dataset/dataset.hpp"
#include "scheduler/service/server.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// Everything one scheduler process has of a build. Holding it means holding the lock of the state
/// directory.
class Build {
 public:
  /// Opens or makes the state of this problem in `state`, and goes on where the last run was. `now`
  /// is of the clock that the coordinator is told later.
  Build(Problem problem, const std::filesystem::path& state, Coordinator::Time now,
        CoordinatorSettings settings = {},
        std::uint64_t segment_bytes = Journal::default_segment_bytes);
  Build(const Build&) = delete;
  Build& operator=(const Build&) = delete;

  const Problem& problem() const { return problem_; }
  Coordinator& coordinator() { return coordinator_; }
  const StateDirectory& directory() const { return directory_; }
  /// Reads every record that the dataset of a complete build is made of. DamagedRecord when one is
  /// not what was written.
  void verify() const;
  /// Marks a damaged record: the next Build in this directory computes it again.
  void drop(const DamagedRecord& damage) { store_.drop(damage.where()); }
  /// Keeps these workers out: the next Build in this directory computes again what they gave.
  void keepOut(const LiarsFound& found) { store_.keepOut(found.liars()); }
  /// Writes the dataset of a complete build; returns its tables.
  std::vector<SpaceTable> seal(const std::filesystem::path& file);

 private:
  JournalRecord recordOf(std::size_t space, std::int32_t point) const;

  const Problem problem_;
  const std::string problem_bytes_;
  StateDirectory directory_;
  JobStore store_;
  Coordinator coordinator_;
};

/// done, or partly_failed when a point failed that was tried. Unreachable ones lie beyond max_force
/// by design, or behind points that did fail. Probes do not count.
ExitCode exitCodeOf(const std::vector<SpaceTable>& spaces);

}  // namespace palpate
