#include "tests/simulation/scenario.hpp"

#include "common/base/whole_file.hpp"
#include "common/dataset/dataset.hpp"
#include "scheduler/state/job_store.hpp"
#include "scheduler/state/replay.hpp"
#include "tests/simulation/history.hpp"
#include "tests/support/solved_table.hpp"

namespace palpate::simulation {
namespace {

Scenario made(Problem problem, Solver solve, const std::filesystem::path& folder) {
  Scenario scenario{std::move(problem), solve, {}};
  scenario.sealed = scenario.sealedWith({}, folder);
  return scenario;
}

}  // namespace

Scenario Scenario::rough(const std::filesystem::path& folder) {
  return made(test::cubeProblem(), test::solve, folder);
}

Scenario Scenario::smooth(const std::filesystem::path& folder) {
  return made(test::wideProblem(), test::solveSmoothly, folder);
}

const Scenario& Scenarios::of(std::uint64_t seed) const {
  return mayHaveLiar(seed) ? smooth : rough;
}

std::string Scenario::sealedWith(const FalseResults& instead,
                                 const std::filesystem::path& folder) const {
  std::vector<SpacePlan> plans;
  std::map<TransitionKey, std::string> fields;
  for (std::uint32_t space = 0; space < problem.active.size(); ++space) {
    SpacePlan& plan = plans.emplace_back(problem, space);
    for (auto ready = plan.takeReady(); !ready.empty(); ready = plan.takeReady())
      for (const Transition& transition : ready) {
        const ResultKey key = {space, plan.positions().point(transition.target),
                               plan.positions().point(transition.parent)};
        auto [result, payload] = solve(problem, space, key.target, key.parent);
        result.mutable_cost()->set_steps(plan.stepsOf(transition));
        if (const auto other = instead.find(key); other != instead.end()) result = other->second;
        plan.record(transition, *fromWire(result), fieldsOf(result));
        fields[{space, transition.target, transition.parent}] = std::move(payload);
      }
  }
  const std::filesystem::path file = folder / "undisturbed.h5";
  sealDataset(file, problem, spaceTables(plans), "baseline",
              [&](std::size_t space, std::int32_t point) {
                const TransitionKey key = {static_cast<std::uint32_t>(space), point,
                                           plans[space].points().parent(point)};
                return NodalFields::decode(fields.at(key), problem.mesh.nodes.size(),
                                           problem.pressures.count());
              });
  return readText(file, "the dataset");
}

}  // namespace palpate::simulation
