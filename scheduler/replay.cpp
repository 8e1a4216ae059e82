#include "scheduler/replay.hpp"

#include <map>

#include "common/error.hpp"

namespace palpate {

Ending endingOf(const Outcome& outcome) {
  if (outcome.converged) return {true, outcome.equilibrium.force.norm(), Cause::none, 1};
  return {false, 0, outcome.failure.cause, outcome.failure.step_reached};
}

Replay replay(const Problem& problem, const Lattice& lattice, const std::vector<StoredResult>& results) {
  std::map<TransitionKey, const Outcome*> known;
  for (const StoredResult& result : results) known.emplace(result.key, &result.outcome);
  Replay replayed;
  for (std::uint32_t space = 0; space < problem.active.size(); ++space) {
    Frontier& frontier = replayed.frontiers.emplace_back(lattice, problem.scene.workspace.max_force);
    for (auto ready = frontier.takeReady(); !ready.empty(); ready = frontier.takeReady())
      for (const Transition& transition : ready) {
        const TransitionKey key{space, transition.target, transition.parent};
        const auto found = known.find(key);
        if (found == known.end()) {
          replayed.open.push_back(key);
          continue;
        }
        frontier.record(transition, endingOf(*found->second));
        known.erase(found);
      }
  }
  if (known.empty()) return replayed;
  const TransitionKey& key = known.begin()->first;
  throw failure(
      "the state directory holds {} results that nobody asked for (the first: space {}, point {} from point "
      "{}): "
      "it is damaged; restore it from a copy, or remove it to compute everything again",
      known.size(), key.space, key.target, key.parent);
}

std::vector<SpaceTable> spaceTables(const Problem& problem, const std::vector<Frontier>& frontiers,
                                    const std::vector<StoredResult>& results) {
  std::vector<SpaceTable> tables;
  for (std::size_t space = 0; space < frontiers.size(); ++space) {
    SpaceTable& table = tables.emplace_back();
    table.patch = problem.active[space];
    table.lattice = frontiers[space].lattice();
    table.points.resize(static_cast<std::size_t>(frontiers[space].size()));
    for (std::int32_t point = 0; point < frontiers[space].size(); ++point) {
      table.points[point].tag = frontiers[space].tag(point);
      if (table.points[point].tag == Tag::failed) table.points[point].cause = frontiers[space].cause(point);
    }
  }
  for (const StoredResult& result : results) {
    SpaceTable& table = tables.at(result.key.space);
    if (!result.outcome.converged) {
      table.attempts.push_back({result.key.target, result.key.parent, result.outcome.failure});
      continue;
    }
    PointRecord& record = table.points.at(static_cast<std::size_t>(result.key.target));
    record.parent = result.key.parent;
    record.equilibrium = result.outcome.equilibrium;
    record.residual = result.outcome.residual;
    record.cost = result.outcome.cost;
    record.fields = *ContentId::fromBytes(result.header.fields_id());
  }
  return tables;
}

}  // namespace palpate
