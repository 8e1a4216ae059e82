#include "scheduler/builds/recorded_build.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/left_open.hpp"
#include "tests/support/scanned_journal.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

/// Calls a function when the first line is logged.
class AtFirstLine : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit AtFirstLine(std::function<void()> then) : then_(std::move(then)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& /*line*/) override {
    if (then_) std::exchange(then_, {})();
  }
  void flush_() override {}

  std::function<void()> then_;
};

struct RecordedBuildTest : testing::Test {
  test::BuildWorld world;
  std::filesystem::path state = world.directory / "state", out = world.directory / "now.h5";

  /// Solves at most `jobs` jobs.
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

  /// Completes a build whose journal has a record that was dropped and computed again.
  void completeWithDamage() {
    world.join("a", 1);
    solveJobs(7);
    const JournalPosition last = test::scanned(JournalReader(state)).records.back().where;
    world.build().drop(DamagedRecord(last, "a test"));
    world.restart();
    world.join("a", 1);
    world.finish({"a"});
  }
  /// Another process changes the tables after the journal was read, when its damage is reported,
  /// and before the next read.
  std::unique_ptr<RecordedBuild> readWhileTablesChange(const std::string& sql) const {
    const auto before = spdlog::default_logger();
    spdlog::set_default_logger(std::make_shared<spdlog::logger>(
        "while", std::make_shared<AtFirstLine>([&] {
          Database(StateDirectory::databaseIn(state), Database::Access::read_write_create)
              .execute(sql);
        })));
    auto recorded = std::make_unique<RecordedBuild>(state);
    spdlog::set_default_logger(before);
    return recorded;
  }
};

TEST_F(RecordedBuildTest, SealsTheResultsSoFarAtAnyTime) {
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
  EXPECT_EQ(Dataset(out).contentId(), world.sealedContent())
      << "whichever command seals a complete build";
}

TEST_F(RecordedBuildTest, HasNothingToSealBeforeTheFirstResult) {
  test::expectError(ExitCode::failed, [&] { RecordedBuild(state).seal(out); },
                    {"state", "no result is recorded there yet"});
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(RecordedBuildTest, OnlyAWholeDatasetIsFinishedWork) {
  world.join("a", 1);
  solveJobs(7);
  RecordedBuild(state).seal(out);
  EXPECT_FALSE(isSealed(out, world.problem, false));
  world.finish({"a"});
  RecordedBuild(state).seal(out);
  EXPECT_TRUE(isSealed(out, world.problem, false));
}

TEST_F(RecordedBuildTest, ADatasetLeftOpenForWritingIsNotReplaced) {
  world.join("a", 1);
  world.finish({"a"});
  RecordedBuild(state).seal(out);
  test::leaveOpenForWriting(out);
  try {
    isSealed(out, world.problem, false);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("h5clear -s"));
    EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("--replace")));
  }
}

TEST_F(RecordedBuildTest, LeavesOutResultsOfExcludedWorkers) {
  world.join("a", 1);
  solveJobs(7);
  KeptOut liar;
  liar.kind = KeptOut::Kind::machine;
  liar.who.set_host("here");
  liar.reason = "a test";
  world.build().keepOut({liar});
  test::expectError(ExitCode::failed, [&] { RecordedBuild(state).seal(out); },
                    {"no result is recorded there yet"});
}

TEST_F(RecordedBuildTest, ReportsProgressFromTheTablesOrElseFromTheJournal) {
  const auto expectAsTheSchedulerSays = [&](const wire::Status& told) {
    const wire::Status said = world.coordinator().status(world.now);
    EXPECT_EQ(told.build(), said.build());
    EXPECT_EQ(told.scene(), said.scene());
    EXPECT_EQ(told.kernel_family(), said.kernel_family());
    ASSERT_EQ(told.spaces_size(), said.spaces_size());
    for (int n = 0; n < said.spaces_size(); ++n)
      EXPECT_EQ(told.spaces(n).ShortDebugString(), said.spaces(n).ShortDebugString());
    EXPECT_EQ(told.ready(), said.ready());
    EXPECT_EQ(told.state(), said.state() == "complete" ? "complete" : "stopped");
  };
  world.join("a", 1);
  solveJobs(7);
  world.pass(6s);
  expectAsTheSchedulerSays(progressIn(state));
  world.finish({"a"});
  expectAsTheSchedulerSays(progressIn(state));
  const std::filesystem::path copy = world.directory / "copy";
  std::filesystem::copy(state, copy);
  std::filesystem::remove(copy / "segment-000001.dat");
  expectAsTheSchedulerSays(progressIn(copy));
  Database(StateDirectory::databaseIn(state), Database::Access::read_write_create)
      .execute("DELETE FROM meta WHERE key = 'recorded'");
  expectAsTheSchedulerSays(progressIn(state));
}

/// Regression: a dataset was sealed as complete despite a dispute that began while the journal was
/// read.
TEST_F(RecordedBuildTest, ACheckBegunWhileTheJournalIsReadPreventsCompletion) {
  completeWithDamage();
  ASSERT_TRUE(RecordedBuild(state).complete());
  const auto recorded = readWhileTablesChange("INSERT INTO checks VALUES (0, 1, 0, 0, 0, 0, 0, 1)");
  EXPECT_FALSE(recorded->complete());
  recorded->seal(out);
  EXPECT_TRUE(Dataset(out).isPartial());
}

TEST_F(RecordedBuildTest, ALiarFoundWhileTheJournalIsReadIsLeftOutToo) {
  completeWithDamage();
  const auto recorded =
      readWhileTablesChange("INSERT INTO kept_out VALUES ('machine', x'', 'here', x'', 'a test')");
  EXPECT_EQ(recorded->kernelFamily(), "") << "no other worker delivered a result";
  EXPECT_FALSE(recorded->complete());
}

}  // namespace
}  // namespace palpate
