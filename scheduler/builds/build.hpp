#pragma once

#include "common/base/program.hpp"
#include "common/dataset/dataset.hpp"
#include "scheduler/service/server.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// Returns the record of a result; none if no result with this key is recorded.
using RecordSource = std::function<std::optional<JournalRecord>(const ResultKey&)>;

/// One build in its state directory: the problem, the journal, the tables, and the coordinator.
/// Holds the lock of the state directory for its lifetime.
class Build {
 public:
  /// Opens or creates the state of this problem in `state` and resumes where the last run ended.
  /// `now` must come from the same clock as the times of later calls to the coordinator. Throws
  /// Error (bad input) if the recorded results were computed with other kernels than
  /// settings.kernel_family.
  Build(Problem problem, const std::filesystem::path& state, Coordinator::Time now,
        const CoordinatorSettings& settings = {},
        std::uint64_t segment_bytes = Journal::default_segment_bytes);
  Build(const Build&) = delete;
  Build& operator=(const Build&) = delete;

  const Problem& problem() const { return problem_; }
  Coordinator& coordinator() { return coordinator_; }
  const StateDirectory& directory() const { return directory_; }
  /// Reads every record that the dataset of a complete build needs. Throws DamagedRecord.
  void verify() const;
  /// Marks a damaged record as dropped; the next Build in this directory computes its result again.
  void drop(const DamagedRecord& damage) { store_.drop(damage.where()); }
  /// Excludes these workers, machines or keys; the next Build in this directory computes their
  /// results again.
  void keepOut(const std::vector<KeptOut>& liars) { store_.keepOut(liars); }
  /// Writes the dataset of a complete build. Returns its rows, valid for the lifetime of this
  /// Build.
  SpaceRowsList seal(const std::filesystem::path& file);

 private:
  const CoordinatorSettings& checked(const CoordinatorSettings& settings) const;
  RecordSource finder() const;

  const Problem problem_;
  const std::string problem_bytes_;
  StateDirectory directory_;
  JobStore store_;
  Coordinator coordinator_;
};

/// Returns true if `file` already is the complete dataset of this build. Returns false if the file
/// does not exist, or if it is a dataset of this build that is partial or has other storage
/// settings (Storage). In all other cases, returns false if `replace` is set, and throws Error (bad
/// input) if not.
bool isSealed(const std::filesystem::path& file, const Problem& problem, bool replace);

/// Writes the dataset of these plans and returns its rows. `find` returns the recorded results.
/// `partial` marks the dataset as unfinished, because a plan is incomplete or a check is still
/// open.
SpaceRowsList sealPlans(const std::filesystem::path& file, const Problem& problem,
                        const std::vector<SpacePlan>& plans, const std::string& kernel_family,
                        const RecordSource& find, bool partial);

/// Returns partly_failed if the solve of some point failed, else done. Ignores probes, and failed
/// points with the cause `beyond_force` or `unreachable` (docs/failures.md).
ExitCode exitCodeOf(const SpaceRowsList& spaces);

}  // namespace palpate
