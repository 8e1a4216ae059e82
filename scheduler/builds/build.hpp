#pragma once

#include "common/base/program.hpp"
#include "common/dataset/dataset.hpp"
#include "scheduler/service/server.hpp"
#include "scheduler/state/state_directory.hpp"

namespace palpate {

/// A recorded result; nothing when there is none with this key.
using RecordSource = std::function<std::optional<JournalRecord>(const ResultKey&)>;

/// Everything one scheduler process has of a build. Holding it means holding the lock of the state
/// directory.
class Build {
 public:
  /// Opens or makes the state of this problem in `state`, and goes on where the last run was. `now`
  /// is of the clock that the coordinator is told later. Error (bad input) when what is recorded
  /// was computed with other kernels than these settings want.
  Build(Problem problem, const std::filesystem::path& state, Coordinator::Time now,
        const CoordinatorSettings& settings = {},
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
  void keepOut(const std::vector<KeptOut>& liars) { store_.keepOut(liars); }
  /// Writes the dataset of a complete build; returns its rows, which are there as long as this is.
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

/// True when `file` is the whole dataset of this build already, false when there is no such file,
/// or when it is that but partial or with another Storage than asked for. Error (bad input) when it
/// is anything else, unless `replace`.
bool isSealed(const std::filesystem::path& file, const Problem& problem, bool replace);

/// Writes the dataset of what these plans have, whose results `find` gives; returns its rows.
/// `partial`: they are not complete, or what others check is not decided.
SpaceRowsList sealPlans(const std::filesystem::path& file, const Problem& problem,
                        const std::vector<SpacePlan>& plans, const std::string& kernel_family,
                        const RecordSource& find, bool partial);

/// done, or partly_failed when a point failed that was tried. Unreachable ones lie beyond max_force
/// by design, or behind points that did fail. Probes do not count.
ExitCode exitCodeOf(const SpaceRowsList& spaces);

}  // namespace palpate
