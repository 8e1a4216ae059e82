#include "scheduler/state/replay.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

std::string startIdOf(const SpacePlan& plan, const Transition& transition) {
  // The origin is its own parent: it is solved from the rest state, which has no id.
  if (transition.target == transition.parent) return "";
  const PointRecord& start = plan.point(transition.parent);
  PALPATE_ASSERT(isSolved(start.tag), "a plan asks for transitions from solved points only");
  return std::string(start.fields.bytes());
}

Settled settle(SpacePlan& plan, std::uint32_t space, StoredResults& known) {
  Settled settled;
  for (auto ready = plan.takeReady(); !ready.empty(); ready = plan.takeReady())
    for (const Transition& transition : ready) {
      const Lattice& positions = plan.positions();
      const auto found = known.find(
          {space, positions.point(transition.target), positions.point(transition.parent)});
      if (found == known.end()) {
        settled.missing.push_back({space, transition.target, transition.parent});
        continue;
      }
      const auto [key, result] = *found;
      known.erase(found);
      if (result.header.start_id() != startIdOf(plan, transition)) {
        settled.stale.push_back(key);
        settled.missing.push_back({space, transition.target, transition.parent});
        continue;
      }
      plan.record(transition, result.outcome, fieldsOf(result.header));
    }
  return settled;
}

Replay replay(const Problem& problem, StoredResults results) {
  Replay replayed;
  replayed.spare = std::move(results);
  for (std::uint32_t space = 0; space < problem.active.size(); ++space) {
    SpacePlan& plan = replayed.plans.emplace_back(problem, space);
    const auto [missing, stale] = settle(plan, space, replayed.spare);
    Settled& all = replayed.settled;
    all.missing.insert(all.missing.end(), missing.begin(), missing.end());
    all.stale.insert(all.stale.end(), stale.begin(), stale.end());
    PALPATE_ASSERT(plan.complete() || plan.openCount() > 0,
                   "a plan that asks for nothing has nothing left to do");
  }
  return replayed;
}

std::vector<ResultKey> failedWith(const std::vector<SpacePlan>& plans, Cause cause) {
  std::vector<ResultKey> keys;
  for (std::uint32_t space = 0; space < plans.size(); ++space) {
    const SpacePlan& plan = plans[space];
    for (std::int32_t n = 0; n < plan.size(); ++n)
      for (const FailedAttempt& attempt : plan.attempts(n))
        if (attempt.failure.cause == cause)
          keys.push_back(
              {space, plan.positions().point(n), plan.positions().point(attempt.parent)});
  }
  return keys;
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
