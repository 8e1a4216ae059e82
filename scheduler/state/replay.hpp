#pragma once

#include <functional>
#include <set>
#include <unordered_map>

#include "common/space/configuration.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/journal.hpp"
#include "scheduler/state/kept_out.hpp"

namespace palpate {

/// The id of a result's nodal fields; all zero of a failure.
ContentId fieldsOf(const wire::Result& result);

/// Where each recorded result lies in the journal, in about 90 bytes each: there may be ten
/// million.
using ResultIndex = std::unordered_map<ResultKey, JournalPosition, HashOfResultKey>;

/// What the journal of a build holds, but for the results themselves.
struct RecordedResults {
  ResultIndex where;  ///< the first of each key
  JournalEnd end;
  std::vector<JournalPosition> torn;  ///< JournalScan::torn
  /// What was recorded once and cannot be read any more, for people: it will be computed again.
  std::vector<std::string> damage;
};

/// A result as the worker sent it, less the lease, and with who gave it; and what it says, without
/// fields.
using TakeResult = std::function<void(const ResultKey&, const wire::Result&, const Outcome&)>;
/// Reads it, and calls `take` with the first result of each key, in the order of recording: all of
/// them may not fit into memory. There is room at once for `expected`; it grows by itself. Error
/// (bad input) when it is the journal of another build.
RecordedResults readResults(const std::filesystem::path& directory, const ContentId& build,
                            const TakeResult& take, std::size_t expected = 0);

/// One that is in the index; nothing when it cannot be read any more, which is told (log).
std::optional<wire::Result> readRecorded(const JournalReader& journal, const ResultIndex& where,
                                         const ResultKey& key);

/// What a transition of a plan starts from, as jobs and results name it: the id of its parent's
/// fields; empty when that is the rest state.
std::string startIdOf(const SpacePlan& plan, const Transition& transition);

/// What becomes of results when they are put into a plan.
struct Settled {
  std::vector<ResultKey> missing;  ///< ready, and not known: to be solved
  /// Known, but from another start than the plan has: what their parent was, is no more. Or they
  /// cannot be read any more. They are among the missing.
  std::vector<ResultKey> outdated;
};
/// Recorded results that no plan has asked for yet. They will, where what led there was lost.
using UnclaimedResults = std::set<ResultKey>;
/// One of them; nothing when it cannot be read any more.
using ReadUnclaimed = std::function<std::optional<wire::Result>(const ResultKey&)>;
/// Records in the plan those of the unclaimed ones whose transitions are ready, and those that this
/// makes ready, and so on; takes them out.
Settled settle(SpacePlan& plan, UnclaimedResults& unclaimed, const ReadUnclaimed& read);

/// Puts recorded results into fresh plans, one after the other, in the order in which they were
/// recorded: then each is asked for when it comes, unless something was lost before it.
class Replay {
 public:
  /// `problem` must outlive the plans.
  explicit Replay(const Problem& problem);

  /// A result that is recorded. Each key once.
  void take(const ResultKey& key, const wire::Result& result, const Outcome& outcome);
  /// After the last of them.
  void finish(const ReadUnclaimed& read);

  std::vector<SpacePlan> plans;  ///< one per active node of the problem
  Settled settled;               ///< of all of them, once it is finished
  UnclaimedResults unclaimed;
};

/// A journal whose results are in plans, but for those of liars.
struct ReplayedJournal {
  explicit ReplayedJournal(const Problem& problem) : replay(problem) {}
  RecordedResults recorded;
  Replay replay;
  std::vector<ResultKey> of_liars;  ///< left out
  // Of all that was not left out.
  std::size_t results = 0;
  std::string kernel_family;                               ///< empty without any
  double longest_solve = 0;                                ///< s
  std::set<std::pair<std::string, std::string>> machines;  ///< that gave them: key and host
};
/// Reads the journal in `directory`, which holds some `expected` results. Errors are those of
/// readResults().
ReplayedJournal replayJournal(const std::filesystem::path& directory, const Problem& problem,
                              const ContentId& build, const std::vector<KeptOut>& liars,
                              std::size_t expected = 0);

/// The results of all attempts that failed with this cause.
std::vector<ResultKey> failedWith(const std::vector<SpacePlan>& plans, Cause cause);

/// Error when a replay of a journal that is whole left results that nobody asked for: another
/// version of the program, which asked for others, began it.
void refuseUnclaimed(const UnclaimedResults& unclaimed);

/// The rows of a dataset.
std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans);

}  // namespace palpate
