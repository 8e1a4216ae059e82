#pragma once

#include <vector>

#include "common/dataset.hpp"
#include "common/problem.hpp"
#include "scheduler/frontier.hpp"
#include "scheduler/job_store.hpp"

namespace palpate {

/// Where the recorded results leave a build.
struct Replay {
  std::vector<Frontier> frontiers;  ///< one per active node of the problem
  std::vector<TransitionKey> open;  ///< ready, and not recorded
};

/// Records every result in fresh frontiers. Error when one of them was never asked for: the tables are
/// damaged.
Replay replay(const Problem& problem, const Lattice& lattice, const std::vector<StoredResult>& results);

/// How a transition ended, as far as a frontier cares.
Ending endingOf(const Outcome& outcome);

/// The rows of a dataset. `frontiers` have recorded exactly `results`, which are in the order of
/// JobStore::results().
std::vector<SpaceTable> spaceTables(const Problem& problem, const std::vector<Frontier>& frontiers,
                                    const std::vector<StoredResult>& results);

}  // namespace palpate
