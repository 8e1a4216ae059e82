#include "scheduler/builds/build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/verbs/status_text.hpp"
#include "tests/scheduler/build_world.hpp"

namespace palpate {
namespace {

/// One space whose points end with these tags and causes.
std::vector<SpaceTable> spaceOf(const std::vector<std::pair<Tag, Cause>>& ends) {
  std::vector<SpaceTable> spaces(1);
  spaces[0].patch.name = "tip";
  for (const auto& [tag, cause] : ends) {
    spaces[0].points.emplace_back().tag = tag;
    spaces[0].points.back().cause = cause;
  }
  return spaces;
}

TEST(ExitCodeOfABuild, CountsFailedWorkAndNotUnreachablePoints) {
  const std::pair<Tag, Cause> expandable{Tag::expandable, Cause::none},
      terminating{Tag::terminating, Cause::none}, unreachable{Tag::failed, Cause::unreachable},
      too_strong{Tag::failed, Cause::beyond_force}, failed{Tag::failed, Cause::step_budget};
  EXPECT_EQ(exitCodeOf(rowsOf(spaceOf({expandable, terminating}))), ExitCode::done);
  EXPECT_EQ(exitCodeOf(rowsOf(spaceOf({expandable, terminating, unreachable}))), ExitCode::done);
  EXPECT_EQ(exitCodeOf(rowsOf(spaceOf({expandable, terminating, too_strong}))), ExitCode::done);
  EXPECT_EQ(exitCodeOf(rowsOf(spaceOf({expandable, failed, unreachable}))),
            ExitCode::partly_failed);
}

TEST(SummaryOfABuild, CountsFailedPointsByCause) {
  const auto spaces = spaceOf({{Tag::expandable, Cause::none},
                               {Tag::failed, Cause::unreachable},
                               {Tag::failed, Cause::unreachable},
                               {Tag::failed, Cause::step_budget}});
  EXPECT_THAT(summaryOf(rowsOf(spaces), Scene()),
              testing::HasSubstr("failed: 1 step_budget, 2 unreachable\n"));
}

TEST(SummaryOfABuild, TellsProbesApartFromPoints) {
  auto spaces = spaceOf({{Tag::expandable, Cause::none}});
  spaces.push_back(spaces.front());
  spaces[1].patch.probe = Eigen::Vector3d(0, 0, 0.01);
  spaces[1].patch.name = "skin-probe-0";
  spaces[1].probes.emplace_back().record.tag = Tag::expandable;
  spaces[1].probes.emplace_back().record.tag = Tag::terminating;
  for (const Cause cause : {Cause::beyond_force, Cause::step_budget}) {
    Probe& failed = spaces[1].probes.emplace_back();
    failed.record.tag = Tag::failed;
    failed.record.cause = cause;
  }
  const std::string summary = summaryOf(rowsOf(spaces), Scene());
  EXPECT_THAT(summary,
              testing::HasSubstr("probes: 4, 1 within max_force, 2 beyond it, 1 not solved\n"
                                 "probes not solved: 1 step_budget\n"));
  EXPECT_THAT(summary, testing::Not(testing::HasSubstr("skin-probe-0")));
}

TEST(Build, LeavesNoPointUnknownWhenTheOriginFails) {
  test::BuildWorld world;
  world.join("a", 2);
  for (const wire::Job& job : world.takeJobs("a")) {
    wire::Message message;
    *message.mutable_result() = test::solve(world.problem, job.space(), {}, {}).first;
    wire::Result& result = *message.mutable_result();
    const Outcome stuck = {Failure{.cause = Cause::factorization_failed}, {}};
    result.clear_fields_id();
    toWire(stuck, "", result);
    result.clear_payload_bytes();
    world.prove("a", result);
    world.send("a", message);
  }
  world.pass(std::chrono::milliseconds(25));
  ASSERT_TRUE(world.coordinator().complete());
  const wire::Status status = world.coordinator().status(world.now);
  EXPECT_EQ(status.failed_points().at("unreachable"), 64);
  EXPECT_EQ(status.failed_points().at("factorization_failed"), 2);
  EXPECT_THAT(describe(status),
              testing::HasSubstr("failed points: 2 factorization_failed, 64 unreachable\n"));
  world.sealedContent();
  const Dataset dataset(world.directory / "cube.h5");
  for (const SpaceTable& space : dataset.spaces())
    EXPECT_EQ(space.points[1].cause, Cause::unreachable);
}

}  // namespace
}  // namespace palpate
