#include "scheduler/state/tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/scheduler/state/synced_files.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/solved_table.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::Pair;
using testing::SizeIs;

struct TablesTest : testing::Test {
  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  const StateDirectory held{directory / "state"};

  Tables open() { return {held, problem}; }

  void alter(const std::string& sql) const {
    Database(held.database(), Database::Access::read_write_create).execute(sql);
  }
};

TEST_F(TablesTest, StoreTheProgressUntilAResultIsDropped) {
  Tables tables = open();
  EXPECT_FALSE(tables.progress());
  tables.writeProgress({7, "some"});
  tables.writeProgress({12, "all"});
  EXPECT_EQ(StoredTables(held.path()).progress()->recorded, 12u);
  EXPECT_EQ(StoredTables(held.path()).progress()->status, "all");
  tables.forgetProgress();
  EXPECT_FALSE(StoredTables(held.path()).progress());
}

/// Regression: the result of a worker that contradicted another one was acknowledged, but a power
/// cut removed the dispute.
TEST_F(TablesTest, WriteADisputeToDiskAtOnce) {
  const ResultKey key = {0, {1, -2, 3}, {1, -2, 2}};
  Tables tables = open();
  std::vector<std::string> synced;
  test::synced_files = &synced;
  tables.writeCheck(key, false);
  const std::size_t of_check = synced.size();
  tables.writeCheck(key, true);
  test::synced_files = nullptr;
  EXPECT_EQ(of_check, 0u) << "one of a hundred results";
  EXPECT_THAT(synced, testing::Contains(testing::EndsWith("-wal")));
}

TEST_F(TablesTest, RememberExclusionsToTheLastByte) {
  KeptOut process, machine;
  process.who.set_worker(std::string("\0w\xff", 3));
  process.reason = "it's wrong";
  machine.kind = KeptOut::Kind::machine;
  machine.who.set_host("n'1");
  machine.who.set_key(std::string(32, '\0'));
  open().keepOut(std::vector{process});
  open().keepOut(std::vector{machine});
  StoredTables tables(held.path());
  EXPECT_THAT(tables.keptOut(), ElementsAre(process, machine));
  EXPECT_EQ(tables.keptOut()[0].reason, "it's wrong");
}

TEST_F(TablesTest, RememberPauseAndPriorities) {
  EXPECT_FALSE(open().paused());
  open().writePaused(true);
  open().writePriority("tip", 3);
  open().writePriority("probes of top", -2);
  open().writePriority("tip", 0);
  Tables tables = open();
  EXPECT_TRUE(tables.paused());
  EXPECT_THAT(tables.priorities(), ElementsAre(Pair("probes of top", -2), Pair("tip", 0)));
  tables.writePaused(false);
  EXPECT_FALSE(StoredTables(held.path()).paused());
}

TEST_F(TablesTest, RememberTransitionsToSolveAgainUntilForgotten) {
  const ResultKey first = {0, {1, -2, 3}, {1, -2, 2}}, beside = {0, {1, -2, 3}, {0, -2, 2}},
                  turned = {0, {1, -2, 2}, {1, -2, 3}}, second = {1, {1, -2, 3}, {1, -2, 2}};
  Tables tables = open();
  for (const ResultKey& key : {first, second, turned, beside}) tables.writeCheck(key, false);
  tables.writeCheck(second, true);
  EXPECT_THAT(open().checks(), ElementsAre(Pair(turned, false), Pair(beside, false),
                                           Pair(first, false), Pair(second, true)));
  tables.forgetCheck(first);
  tables.forgetCheck({2, {}, {}});
  EXPECT_THAT(open().checks(),
              ElementsAre(Pair(turned, false), Pair(beside, false), Pair(second, true)));
}

TEST_F(TablesTest, HaveTheirOwnSecretAndReplaceADamagedOne) {
  const std::string secret = open().secret();
  EXPECT_THAT(secret, SizeIs(32));
  EXPECT_EQ(open().secret(), secret);
  const StateDirectory other(directory / "other");
  EXPECT_NE(Tables(other, problem).secret(), secret);
  for (const char* damage : {"UPDATE meta SET value = x'00' WHERE key = 'secret'",
                             "DELETE FROM meta WHERE key = 'secret'"}) {
    const std::string before = open().secret();
    alter(damage);
    const std::string made = open().secret();
    EXPECT_THAT(made, SizeIs(32));
    EXPECT_NE(made, before);
    EXPECT_EQ(open().secret(), made);
  }
}

}  // namespace
}  // namespace palpate
