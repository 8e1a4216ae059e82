#pragma once

#include <functional>
#include <set>
#include <unordered_map>

#include "common/space/configuration.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/journal.hpp"
#include "scheduler/state/kept_out.hpp"

namespace palpate {

/// Returns the id of a result's nodal fields; all zero for a failure.
ContentId fieldsOf(const wire::Result& result);

/// Position of each recorded result in the journal. About 90 bytes per result; there may be ten
/// million.
using ResultIndex = std::unordered_map<ResultKey, JournalPosition, HashOfResultKey>;

/// The index of a build's journal, without the results themselves.
struct RecordedResults {
  ResultIndex where;  ///< the first record of each key
  JournalEnd end;
  std::vector<JournalPosition> torn;  ///< JournalScan::torn
  /// Messages about records that cannot be read any more. Their results are computed again.
  std::vector<std::string> damage;
};

/// Receives a recorded result: the worker's message, without its lease and with its giver, and the
/// outcome in it, without fields.
using TakeResult = std::function<void(const ResultKey&, const wire::Result&, const Outcome&)>;
/// Reads the journal in `directory`. Calls `take` with the first result of each key, in the order
/// of recording, since they may not all fit into memory. `expected` results get room at once; the
/// index grows by itself. Throws (bad input) if the journal belongs to another build.
RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build,
                            const TakeResult& take, std::size_t expected = 0);

/// Returns a result of the index; none, with a log line, if it cannot be read any more.
std::optional<wire::Result> readRecorded(const JournalReader& journal, const ResultIndex& where,
                                         const ResultKey& key);

/// Returns the start of a plan's transition as jobs and results name it: the id of its parent's
/// fields, or empty for the rest state.
std::string startIdOf(const SpacePlan& plan, const Transition& transition);

/// Outcome of recording known results in a plan.
struct Settled {
  std::vector<ResultKey> missing;  ///< ready and without a usable result: to be solved
  /// Recorded results that are unreadable, or were solved from another start than the plan has
  /// because their parent's result was replaced. They are also in `missing`.
  std::vector<ResultKey> outdated;
};
/// Recorded results that no plan has asked for yet. Plans ask for them once the lost results before
/// them are computed again.
using UnclaimedResults = std::set<ResultKey>;
/// Reads an unclaimed result; none if it cannot be read any more.
using ReadUnclaimed = std::function<std::optional<wire::Result>(const ResultKey&)>;
/// Records in the plan every unclaimed result whose transition is ready, then those that become
/// ready through it, and so on. Recorded results are removed from `unclaimed`.
Settled settle(SpacePlan& plan, UnclaimedResults& unclaimed, const ReadUnclaimed& read);

/// Records results in fresh plans, one after the other, in the order of recording. In this order
/// the plan asks for each result when it comes, unless an earlier one was lost.
class Replay {
 public:
  /// `problem` must outlive the plans.
  explicit Replay(const Problem& problem);

  /// Takes a recorded result; each key once.
  void take(const ResultKey& key, const wire::Result& result, const Outcome& outcome);
  /// Call after the last result.
  void finish(const ReadUnclaimed& read);

  std::vector<SpacePlan> plans;  ///< one per active node of the problem
  Settled settled;               ///< for all plans; complete after finish()
  UnclaimedResults unclaimed;
};

/// A journal whose results are in plans, except the results of excluded workers.
struct ReplayedJournal {
  explicit ReplayedJournal(const Problem& problem) : replay(problem) {}
  RecordedResults recorded;
  Replay replay;
  std::vector<ResultKey> of_liars;  ///< results of excluded workers, left out
  // About the results that were not left out:
  std::size_t results = 0;
  std::string kernel_family;                               ///< empty if there are none
  double longest_solve = 0;                                ///< s
  std::set<std::pair<std::string, std::string>> machines;  ///< givers: key and host
};
/// Reads the journal in `directory`, which holds about `expected` results. Throws like
/// readResults().
ReplayedJournal replayJournal(const std::filesystem::path& directory, const Problem& problem,
                              const ContentId& build, const std::vector<KeptOut>& liars,
                              std::size_t expected = 0);

/// Returns the keys of all attempts that failed with this cause.
std::vector<ResultKey> failedWith(const std::vector<SpacePlan>& plans, Cause cause);

/// Throws if the replay of an undamaged journal left unclaimed results: another version of the
/// program, with other transitions, recorded them.
void refuseUnclaimed(const UnclaimedResults& unclaimed);

/// Returns the rows of a dataset.
std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans);

}  // namespace palpate
