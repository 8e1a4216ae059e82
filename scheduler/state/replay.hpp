#pragma once

#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Records in `plan`, of `space`, what `known` holds of the transitions that are ready, and of
/// those that this makes ready, and so on; takes it out of `known`. Returns those that are not
/// known: they are to be solved.
std::vector<TransitionKey> settle(SpacePlan& plan, std::uint32_t space, StoredResults& known);

/// Where the recorded results leave a build.
struct Replay {
  std::vector<SpacePlan> plans;        ///< one per active node of the problem
  std::vector<TransitionKey> missing;  ///< ready, and not recorded
  /// Results that the plans have not asked for yet. They will, where what led there was lost.
  StoredResults spare;
};

/// Records every result in fresh plans. `problem` must outlive them.
Replay replay(const Problem& problem, StoredResults results);

/// Error when a replay of a journal that is whole left results that nobody asked for: another
/// version of the program, which asked for others, began it.
void refuseSpare(const StoredResults& spare);

/// The rows of a dataset.
std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans);

}  // namespace palpate
