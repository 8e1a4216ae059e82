#pragma once

#include <functional>
#include <set>
#include <unordered_map>

#include "common/space/configuration.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/journal.hpp"
#include "scheduler/state/kept_out.hpp"

namespace palpate {

/// Returns the id of a result's nodal fields; all zero for a failed solve.
ContentId fieldsOf(const wire::Result& result);

/// Position of each recorded result in the journal. Takes about 90 bytes per result, and a build
/// may have ten million results.
using ResultIndex = std::unordered_map<ResultKey, JournalPosition, HashOfResultKey>;

/// The index of a build's journal, without the results themselves.
struct RecordedResults {
  ResultIndex where;  ///< position of the first record of each key
  JournalPosition end;
  std::vector<JournalPosition> torn;  ///< see JournalScan::torn
  /// Messages about records that can no longer be read. Their results are computed again.
  std::vector<std::string> damage;
};

/// Receives one recorded result. The message is the one that the worker sent, without its lease but
/// with the worker's provenance. The outcome is decoded from the message and holds no nodal fields.
using TakeResult = std::function<void(const ResultKey&, const wire::Result&, const Outcome&)>;
/// Reads the journal in `directory` and calls `take` for each result, in the order of recording.
/// Results are passed one at a time, because they may not all fit into memory. If a key was
/// recorded more than once, only its first result is passed. `expected` is the likely number of
/// results: memory for the index is reserved in advance. Throws (bad input) if the journal belongs
/// to another build.
RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build,
                            const TakeResult& take, std::size_t expected = 0);

/// Reads the result with this key, which must be in the index. If the record can no longer be read,
/// logs that and returns none.
std::optional<wire::Result> readRecorded(const JournalReader& journal, const ResultIndex& where,
                                         const ResultKey& key);

/// Returns the start id of a transition, as jobs and results give it: the id of the parent's nodal
/// fields, or empty if the transition starts from the rest state.
std::string startIdOf(const SpacePlan& plan, const Transition& transition);

/// The remaining work of a plan after recorded results were entered into it.
struct Settled {
  std::vector<ResultKey> missing;  ///< ready transitions without a usable result: to be solved
  /// Recorded results that cannot be used. Either they are unreadable, or they started from fields
  /// that the parent no longer has, because the parent's result was replaced. They are also in
  /// `missing`.
  std::vector<ResultKey> outdated;
};
/// Recorded results that no plan has asked for yet. A plan asks for them once the lost results that
/// they depend on have been computed again.
using UnclaimedResults = std::set<ResultKey>;
/// Reads an unclaimed result; none if it can no longer be read.
using ReadUnclaimed = std::function<std::optional<wire::Result>(const ResultKey&)>;
/// Records in the plan every unclaimed result whose transition is ready. Repeats this for the
/// transitions that thereby become ready, until no result is left that fits. Removes the recorded
/// and the outdated results from `unclaimed`, and adds what remains to do to `settled`.
void settle(SpacePlan& plan, UnclaimedResults& unclaimed, const ReadUnclaimed& read,
            Settled& settled);

/// Rebuilds the plans of a problem from recorded results, which must come in the order of
/// recording. In this order a plan already waits for each result, unless an earlier result was
/// lost.
class Replay {
 public:
  /// `problem` must outlive the plans.
  explicit Replay(const Problem& problem);

  /// Records a result in its plan, or in `unclaimed` if the plan does not wait for it. Call at most
  /// once per key.
  void take(const ResultKey& key, const wire::Result& result, const Outcome& outcome);
  /// Records the unclaimed results that a plan now waits for. Call after the last result.
  void finish(const ReadUnclaimed& read);

  std::vector<SpacePlan> plans;  ///< one per active node of the problem
  Settled settled;               ///< for all plans; complete after finish()
  UnclaimedResults unclaimed;
};

/// A replayed journal: its index, and the plans with all results except those of excluded workers.
struct ReplayedJournal {
  explicit ReplayedJournal(const Problem& problem) : replay(problem) {}
  RecordedResults recorded;
  Replay replay;
  std::vector<ResultKey> of_liars;  ///< results of excluded workers; not in the plans
  // Properties of the results that are in `replay`:
  std::size_t results = 0;
  std::string kernel_family;  ///< empty if there are none
  double longest_solve = 0;   ///< s
  /// key and host of each machine that computed any of them
  std::set<std::pair<std::string, std::string>> machines;
};
/// Replays the journal in `directory`, which holds about `expected` results. Leaves out the results
/// of `liars`. Throws like readResults().
ReplayedJournal replayJournal(const std::filesystem::path& directory, const Problem& problem,
                              const ContentId& build, const std::vector<KeptOut>& liars,
                              std::size_t expected = 0);

/// Returns the keys of all attempts that failed with this cause.
std::vector<ResultKey> failedWith(const std::vector<SpacePlan>& plans, Cause cause);

/// Throws if there are unclaimed results. Call only after the replay of an undamaged journal, where
/// they come from another version of the program.
void refuseUnclaimed(const UnclaimedResults& unclaimed);

}  // namespace palpate
