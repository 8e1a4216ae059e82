#include "scheduler/state/replay.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

std::vector<TransitionKey> settle(SpacePlan& plan, std::uint32_t space, StoredResults& known) {
  std::vector<TransitionKey> missing;
  for (auto ready = plan.takeReady(); !ready.empty(); ready = plan.takeReady())
    for (const Transition& transition : ready) {
      const Lattice& positions = plan.positions();
      const auto found = known.find(
          {space, positions.point(transition.target), positions.point(transition.parent)});
      if (found == known.end()) {
        missing.push_back({space, transition.target, transition.parent});
        continue;
      }
      const StoredResult result = std::move(known.extract(found).mapped());
      plan.record(transition, result.outcome, fieldsOf(result.header));
    }
  return missing;
}

Replay replay(const Problem& problem, StoredResults results) {
  Replay replayed;
  replayed.spare = std::move(results);
  for (std::uint32_t space = 0; space < problem.active.size(); ++space) {
    SpacePlan& plan = replayed.plans.emplace_back(problem, space);
    const std::vector<TransitionKey> missing = settle(plan, space, replayed.spare);
    replayed.missing.insert(replayed.missing.end(), missing.begin(), missing.end());
    PALPATE_ASSERT(plan.complete() || plan.openCount() > 0,
                   "a plan that asks for nothing has nothing left to do");
  }
  return replayed;
}

void refuseSpare(const StoredResults& spare) {
  if (spare.empty()) return;
  const auto& [space, target, parent] = spare.begin()->first;
  throw failure(
      "the state directory holds {} results that nobody asked for (the first: space {}, "
      "point ({}, {}, {}) from ({}, {}, {})): another version of palpate began it, which asked for "
      "others; go on with that one, or remove the directory to compute everything again",
      spare.size(), space, target[0], target[1], target[2], parent[0], parent[1], parent[2]);
}

std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans) {
  std::vector<SpaceTable> tables;
  for (const SpacePlan& plan : plans) tables.push_back(plan.table());
  return tables;
}

}  // namespace palpate
