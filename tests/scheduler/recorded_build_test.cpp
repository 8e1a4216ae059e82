#include "scheduler/recorded_build.hpp"

#include <gtest/gtest.h>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

struct RecordedBuildTest : testing::Test {
  test::BuildWorld world;
  std::filesystem::path state = world.directory / "state", out = world.directory / "now.h5";

  /// So many jobs, if there are as many.
  void solveJobs(int jobs) {
    for (int turns = 0; jobs > 0 && turns < 100 && !world.coordinator().complete(); ++turns) {
      for (const wire::Job& job : world.takeJobs("a")) {
        world.deliver("a", job);
        world.request("a", 1);
        --jobs;
      }
      world.pass(25ms);
    }
  }
};

TEST_F(RecordedBuildTest, SealsAtAnyTimeWhatIsComputedByThen) {
  world.join("a", 1);
  std::int64_t solved = 0;
  while (!world.coordinator().complete()) {
    solveJobs(7);
    RecordedBuild recorded(state);
    recorded.seal(out);
    const Dataset dataset(out);
    dataset.verifyAll();
    EXPECT_EQ(dataset.isPartial(), !world.coordinator().complete());
    EXPECT_EQ(dataset.buildId(), problemId(world.problem));
    std::int64_t now = 0;
    for (const SpaceTable& space : dataset.spaces())
      now += std::ranges::count_if(space.points, [](const auto& p) { return isSolved(p.tag); });
    EXPECT_GE(now, solved);
    solved = now;
  }
  EXPECT_GT(solved, 0);
  EXPECT_EQ(Dataset(out).contentId(), world.sealedContent()) << "whoever seals a complete build";
}

TEST_F(RecordedBuildTest, HasNothingToSealBeforeTheFirstResult) {
  test::expectError(ExitCode::failed, [&] { RecordedBuild(state).seal(out); },
                    {"state", "nothing is recorded there yet"});
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(RecordedBuildTest, APartialDatasetIsNoFinishedWorkAndAWholeOneIs) {
  world.join("a", 1);
  solveJobs(7);
  RecordedBuild(state).seal(out);
  EXPECT_FALSE(isSealed(out, world.problem, false));
  world.finish({"a"});
  RecordedBuild(state).seal(out);
  EXPECT_TRUE(isSealed(out, world.problem, false));
}

TEST_F(RecordedBuildTest, LeavesOutWhatWorkersGaveThatAreKeptOut) {
  world.join("a", 1);
  solveJobs(7);
  KeptOut liar;
  liar.kind = KeptOut::Kind::machine;
  liar.who.set_host("here");
  liar.reason = "a test";
  world.build().keepOut(LiarsFound({liar}));
  test::expectError(ExitCode::failed, [&] { RecordedBuild(state).seal(out); },
                    {"nothing is recorded there yet"});
}

}  // namespace
}  // namespace palpate
