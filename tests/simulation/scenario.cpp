#include "tests/simulation/scenario.hpp"

#include <cmath>
#include <cstring>
#include <stdexcept>

#include "common/base/whole_file.hpp"
#include "common/dataset/dataset.hpp"
#include "scheduler/state/job_store.hpp"
#include "scheduler/state/replay.hpp"
#include "tests/simulation/history.hpp"
#include "tests/support/solved_table.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate::simulation {
namespace {

/// The bytes of a complete record, as at the start of a journal: it says that a neighbour of the
/// origin is unreachable. As floats they are possible pressures.
std::string recordOf(const Problem& problem) {
  wire::Result result;
  result.set_build(std::string(problemId(problem).bytes()));
  *result.mutable_target() = toWire(LatticePoint{1, 0, 0});
  *result.mutable_parent() = toWire(LatticePoint{});
  result.set_kernel_family("baseline");
  result.mutable_failure()->set_cause(1);
  for (;;) {
    const test::TemporaryDirectory folder;
    {
      Journal journal(folder.path(), {});
      journal.append(result.SerializeAsString(), "");
      journal.sync();
    }
    std::string record = readText(folder / "segment-000001.dat", "a journal");
    record.resize((record.size() + sizeof(float) - 1) / sizeof(float) * sizeof(float));
    std::vector<float> numbers(record.size() / sizeof(float));
    std::memcpy(numbers.data(), record.data(), record.size());
    if (std::ranges::all_of(numbers, [](float number) { return std::abs(number) < 1e30F; }))
      return record;
    result.set_steps(result.steps() + 1);
  }
}

/// A solver whose payloads contain the bytes of a record. Damage around these must not turn them
/// into a record.
std::pair<wire::Result, std::string> solveAroundRecord(const Problem& problem, std::uint32_t space,
                                                       const LatticePoint& target,
                                                       const LatticePoint& parent) {
  static const std::string record = recordOf(problem);
  auto [result, payload] = test::solve(problem, space, target, parent);
  if (payload.empty() || target == LatticePoint{}) return {result, payload};
  const std::size_t pressures = problem.pressures.count() * sizeof(float);
  if (record.size() > pressures) throw std::logic_error("no room for a record in the pressures");
  payload.replace(payload.size() - record.size(), record.size(), record);
  result.set_fields_id(std::string(ContentId::of(payload).bytes()));
  return {result, payload};
}

Scenario made(Problem problem, Solver solve, const std::filesystem::path& folder) {
  Scenario scenario{std::move(problem), solve, {}};
  scenario.sealed = scenario.sealedWith({}, folder);
  return scenario;
}

}  // namespace

Scenario Scenario::rough(const std::filesystem::path& folder) {
  return made(test::cubeProblem(), solveAroundRecord, folder);
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
  std::map<ResultKey, std::string> fields;
  for (std::uint32_t space = 0; space < problem.active.size(); ++space) {
    SpacePlan& plan = plans.emplace_back(problem, space);
    for (auto ready = plan.takeReady(); !ready.empty(); ready = plan.takeReady())
      for (const Transition& transition : ready) {
        const ResultKey key = plan.keyOf(transition);
        auto [result, payload] = solve(problem, space, key.target, key.parent);
        result.mutable_cost()->set_steps(plan.stepsOf(transition));
        if (const auto other = instead.find(key); other != instead.end()) result = other->second;
        plan.record(transition, *fromWire(result), fieldsOf(result));
        fields[key] = std::move(payload);
      }
  }
  const std::filesystem::path file = folder / "undisturbed.h5";
  sealDataset(file, problem, rowsOf(plans), "baseline", [&](std::size_t space, std::int32_t point) {
    const ResultKey key = plans[space].keyOf({point, plans[space].points().parent(point)});
    return NodalFields::decode(fields.at(key), problem.mesh.nodes.size(),
                               problem.pressures.count());
  });
  return readText(file, "the dataset");
}

}  // namespace palpate::simulation
