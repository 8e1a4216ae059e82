#include "scheduler/state/replay.hpp"

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {

Replay replay(const Problem& problem, const std::vector<StoredResult>& results) {
  std::map<TransitionKey, const StoredResult*> known;
  for (const StoredResult& result : results) known.emplace(result.key, &result);
  Replay replayed;
  for (std::uint32_t space = 0; space < problem.active.size(); ++space) {
    SpacePlan& plan = replayed.plans.emplace_back(problem, space);
    for (auto ready = plan.takeReady(); !ready.empty(); ready = plan.takeReady())
      for (const Transition& transition : ready) {
        const TransitionKey key{space, transition.target, transition.parent};
        const auto found = known.find(key);
        if (found == known.end()) {
          replayed.missing.push_back(key);
          continue;
        }
        plan.record(transition, found->second->outcome, fieldsOf(found->second->header));
        known.erase(found);
      }
    PALPATE_ASSERT(plan.complete() || plan.openCount() > 0,
                   "a plan that asks for nothing has nothing left to do");
  }
  if (known.empty()) return replayed;
  const TransitionKey& key = known.begin()->first;
  throw failure(
      "the state directory holds {} results that nobody asked for (the first: space {}, "
      "point {} from point {}): it is damaged, or another version of palpate began it, which asked "
      "for others; go on with that one, restore it from a copy, or remove it to compute everything "
      "again",
      known.size(), key.space, key.target, key.parent);
}

std::vector<SpaceTable> spaceTables(const std::vector<SpacePlan>& plans) {
  std::vector<SpaceTable> tables;
  for (const SpacePlan& plan : plans) tables.push_back(plan.table());
  return tables;
}

}  // namespace palpate
