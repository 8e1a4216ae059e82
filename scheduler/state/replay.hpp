#pragma once

#include "scheduler/plan/space_plan.hpp"
#include "scheduler/state/job_store.hpp"

namespace palpate {

/// Where the recorded results leave a build.
struct Replay {
  std::vector<SpacePlan> plans;        ///< one per active node of the problem
  std::vector<TransitionKey> missing;  ///< ready, and not recorded
};

/// Records every result in fresh plans. Error when one of them was never asked for: the tables are
/// damaged. `problem` must outlive the plans.
Replay replay(const Problem& problem, const std::vector<StoredResult>& results);

/// The rows of a dataset.
std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans);

}  // namespace palpate
