#pragma once

#include "scheduler/state/job_store.hpp"

namespace palpate {

/// What a transition of a plan starts from, as jobs and results name it: the id of its parent's
/// fields; empty when that is the rest state.
std::string startIdOf(const SpacePlan& plan, const Transition& transition);

/// What becomes of results when they are put into a plan.
struct Settled {
  std::vector<TransitionKey> missing;  ///< ready, and not known: to be solved
  /// Known, but from another start than the plan has: what their parent was, is no more. They are
  /// among the missing.
  std::vector<ResultKey> stale;
};
/// Records in `plan`, of `space`, what `known` holds of the transitions that are ready, and of
/// those that this makes ready, and so on; takes it out of `known`.
Settled settle(SpacePlan& plan, std::uint32_t space, StoredResults& known);

/// Where the recorded results leave a build.
struct Replay {
  std::vector<SpacePlan> plans;  ///< one per active node of the problem
  Settled settled;               ///< of all of them
  /// Results that the plans have not asked for yet. They will, where what led there was lost.
  StoredResults spare;
};

/// Records every result in fresh plans. `problem` must outlive them.
Replay replay(const Problem& problem, StoredResults results);

/// The results of all attempts that failed with this cause.
std::vector<ResultKey> failedWith(const std::vector<SpacePlan>& plans, Cause cause);

/// Error when a replay of a journal that is whole left results that nobody asked for: another
/// version of the program, which asked for others, began it.
void refuseSpare(const StoredResults& spare);

/// The rows of a dataset.
std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans);

}  // namespace palpate
