#include "scheduler/service/result_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/causes.hpp"

namespace palpate {
namespace {

/// Regression: limit_point was added, but the largest accepted cause was not raised. Such results
/// would have been dropped and requested again forever.
TEST(ResultCheck, AcceptsFailuresOfEveryCauseThatStopsTransitions) {
  const Problem problem = test::cubeProblem();
  const ResultCheck check(problem, problemId(problem));
  wire::Result result;
  result.set_build(std::string(problemId(problem).bytes()));
  result.set_kernel_family("baseline");
  for (const Cause cause : test::allCauses()) {
    result.mutable_failure()->set_cause(static_cast<std::uint32_t>(cause));
    EXPECT_EQ(check.judge(result, "", "baseline").objection.empty(), stopsTransitions(cause))
        << name(cause);
  }
}

/// Results of a stiffening body, and falsified ones.
struct JudgedResult : testing::Test {
  const Problem problem = test::cubeProblem();
  const ResultCheck check{problem, problemId(problem)};

  std::string objectionTo(const LatticePoint& target,
                          const std::function<void(Outcome&)>& change = {}) const {
    auto [result, payload] = test::solveSmoothly(problem, 0, target, {});
    Outcome outcome = *fromWire(result);
    outcome.configuration().fields =
        NodalFields::decode(payload, problem.mesh.nodes.size(), problem.pressures.count());
    if (change) change(outcome);
    payload = outcome.configuration().fields.encode();
    toWire(outcome, payload, result);
    return check.judge(result, payload, "baseline").objection;
  }
  void refuses(const LatticePoint& target, const char* word,
               const std::function<void(Outcome&)>& change) const {
    EXPECT_THAT(objectionTo(target, change), testing::HasSubstr(word));
  }
};

TEST_F(JudgedResult, HonestResultsPass) {
  EXPECT_EQ(objectionTo({}), "");
  EXPECT_EQ(objectionTo({1, 0, -1}), "");
}

TEST_F(JudgedResult, ResultsThatNoSolverProducesAreRefused) {
  const LatticePoint there = {1, 0, -1};
  const auto tool = 3 * static_cast<std::size_t>(problem.active[0].node),
             held = 3 * static_cast<std::size_t>(problem.fixed[0]);
  refuses(there, "inverted", [](Outcome& o) { o.configuration().equilibrium.min_det_F = -0.1; });
  refuses(there, "residual", [](Outcome& o) { o.configuration().residual = 0.1; });
  refuses(there, "residual", [](Outcome& o) { o.configuration().residual = std::nan(""); });
  refuses(there, "symmetric",
          [](Outcome& o) { o.configuration().equilibrium.stiffness(0, 1) += 1e-9; });
  refuses(there, "configurational force",
          [](Outcome& o) { o.configuration().equilibrium.drive[0] = 1; });
  refuses(there, "fixed node",
          [&](Outcome& o) { o.configuration().fields.displacement[held] = 1e-9F; });
  refuses(there, "requested displacement",
          [&](Outcome& o) { o.configuration().fields.displacement[tool] += 1e-3F; });
  refuses(there, "costs", [](Outcome& o) { o.cost.factorizations = -1; });
  refuses(there, "costs", [](Outcome& o) { o.cost.seconds = std::nan(""); });
}

TEST_F(JudgedResult, TheRestStateMustBeExact) {
  refuses({}, "rest", [](Outcome& o) { o.configuration().equilibrium.force[0] = 1e-300; });
  refuses({}, "rest", [](Outcome& o) { o.configuration().equilibrium.energy = 1e-300; });
  refuses({}, "rest", [](Outcome& o) { o.configuration().fields.displacement.back() = 1e-30F; });
  refuses({}, "unstable", [](Outcome& o) { o.configuration().equilibrium.stiffness *= -1; });
}

TEST(ResultCheck, RefusesImpossibleFailures) {
  const Problem problem = test::cubeProblem();
  const ResultCheck check(problem, problemId(problem));
  const auto objectionTo = [&](const std::function<void(wire::Failure&)>& change) {
    wire::Result result;
    result.set_build(std::string(problemId(problem).bytes()));
    result.set_kernel_family("baseline");
    result.mutable_failure()->set_cause(1);
    change(*result.mutable_failure());
    return check.judge(result, "", "baseline").objection;
  };
  EXPECT_EQ(objectionTo([](wire::Failure&) {}), "");
  EXPECT_NE(objectionTo([](wire::Failure& f) { f.set_step_reached(1.5); }), "");
  EXPECT_NE(objectionTo([](wire::Failure& f) { f.set_element(1'000'000); }), "");
  EXPECT_NE(objectionTo([](wire::Failure& f) { f.set_negative_pivots(-1); }), "");
}

/// Records of older programs name the job and the lease.
TEST(ResultCheck, UnknownFieldsDoNotChangeAResult) {
  wire::Result result, with_another_field;
  result.set_fields_id("id");
  with_another_field.CopyFrom(result);
  constexpr int beyond_all = 1000;
  with_another_field.GetReflection()
      ->MutableUnknownFields(&with_another_field)
      ->AddVarint(beyond_all, 7);
  EXPECT_TRUE(ResultCheck::agree(with_another_field, result));
  result.set_fields_id("another");
  EXPECT_FALSE(ResultCheck::agree(with_another_field, result));
}

TEST(Oddness, IsSmallForConsistentForcesAndEnergiesElseLarge) {
  const Problem problem = test::cubeProblem();
  const auto at = [&](const LatticePoint& point) {
    return fromWire(test::solveSmoothly(problem, 0, point, {}).first)->equilibrium();
  };
  const LatticePoint from = {1, 0, 0}, to = {1, 1, 0};
  const Eigen::Vector3d way(0, problem.scene.workspace.spacing, 0);
  EXPECT_LT(oddnessBeside(at(from), at(to), way), 2);
  Equilibrium wrong = at(to);
  wrong.energy *= 1.1;
  EXPECT_GT(oddnessBeside(at(from), wrong, way), 10);
  wrong = at(to);
  wrong.force *= 1.5;
  EXPECT_GT(oddnessBeside(at(from), wrong, way), 5);
  EXPECT_EQ(oddnessBeside({}, {}, way), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace palpate
