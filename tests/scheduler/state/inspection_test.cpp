#include "scheduler/state/inspection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "scheduler/verbs/inspection_text.hpp"
#include "tests/scheduler/build_world.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/scanned_journal.hpp"
#include "tests/support/unwritable.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;
using test::bytesIn;
using test::flip;
using test::putInto;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using TableState = Inspection::TableState;

/// The state directory of a completed build without a scheduler.
struct InspectionTest : testing::Test {
  InspectionTest() {
    test::BuildWorld world;
    world.join("a", 8);
    world.finish({"a"});
    undisturbed = world.sealedContent();
    fs::copy(world.directory / "state", state);
    // The state of the tables after their scheduler has ended.
    alter("PRAGMA wal_checkpoint(TRUNCATE)");
  }

  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  const fs::path state = directory / "state";
  const fs::path segment = state / "segment-000001.dat";
  const fs::path database = StateDirectory::databaseIn(state);
  ContentId undisturbed;

  Inspection look() { return inspect(state); }
  std::vector<std::string> mend() {
    const StateDirectory held(state);
    return repair(held, inspect(held));
  }
  ReplayedJournal recorded() { return replayJournal(state, problem, problemId(problem), {}); }
  JournalPosition whereIs(const ResultKey& key) { return recorded().recorded.where.at(key); }
  void alter(const std::string& sql) {
    Database(database, Database::Access::read_write_create).execute(sql);
  }
  /// Damages only the page on which the rows of workers begin.
  void damageRows() {
    std::streamoff page = 0;
    {
      Database tables(database, Database::Access::read_only);
      Statement query(tables, "SELECT rootpage FROM sqlite_master WHERE name = 'servers'");
      ASSERT_TRUE(query.step());
      page = query.integer<std::streamoff>(0);
    }
    std::fstream stream(database, std::ios::binary | std::ios::in | std::ios::out);
    stream.seekp((page - 1) * 8192);
    stream << std::string(8192, 'x');
  }
  void append(const std::pair<wire::Result, std::string>& result) {
    Journal journal(state, recorded().recorded.end);
    journal.append(result.first.SerializeAsString(), result.second);
    journal.sync();
  }
  /// Names and bytes of all files.
  std::map<std::string, std::string> files() {
    std::map<std::string, std::string> all;
    for (const auto& entry : fs::directory_iterator(state))
      all[entry.path().filename().string()] = bytesIn(entry.path());
    return all;
  }
  /// The state that the next start of the build finds.
  Replay replayed() { return recorded().replay; }
  void expectWholeAfterRepair() {
    mend();
    const Inspection found = look();
    EXPECT_TRUE(found.whole()) << describe(found, state);
    EXPECT_THAT(mend(), IsEmpty()) << "nothing is left to be done";
  }
};

/// A result that every build of this problem contains: the first step along x.
const ResultKey first_step{0, {1, 0, 0}, {0, 0, 0}};

TEST_F(InspectionTest, TablesThatCannotBeMovedAsideAreAnError) {
  damageRows();
  fs::create_directory(database.string() + ".damaged");
  test::expectError(ExitCode::failed, [&] { mend(); }, {"state.db", "cannot rename"});
}

TEST_F(InspectionTest, FindsAFinishedBuildUndamaged) {
  const Inspection found = look();
  EXPECT_TRUE(found.whole()) << describe(found, state);
  EXPECT_EQ(found.build, problemId(problem));
  EXPECT_EQ(found.scene_name, "cube");
  EXPECT_EQ(found.segments, 1u);
  EXPECT_EQ(found.records, recorded().results);
  EXPECT_EQ(found.bytes, fs::file_size(segment));
  EXPECT_EQ(found.tables, TableState::whole);
  EXPECT_EQ(found.lost_results, 0u);
  EXPECT_THAT(found.lost, IsEmpty());
  EXPECT_EQ(found.spare, 0u);
  EXPECT_THAT(describe(found, state), AllOf(HasSubstr("scene cube"), HasSubstr("whole: ")));
}

TEST_F(InspectionTest, ChangesNothingWhateverItFinds) {
  flip(segment, whereIs(first_step).offset + 60);
  const auto before = files();
  look();
  EXPECT_EQ(files(), before);
  putInto(database, std::string(50000, 'x'));
  const auto overwritten = files();
  EXPECT_EQ(look().tables, TableState::damaged);
  EXPECT_EQ(files(), overwritten);
}

TEST_F(InspectionTest, ReadsAllThatAKilledSchedulerLeftAndChangesNothing) {
  {
    const StateDirectory held(state);
    Tables(held).writeProgress({1000000, ""});
    Database open(database, Database::Access::read_write_create);
    open.execute("UPDATE meta SET value = 2000000 WHERE key = 'recorded'");
    fs::copy(state, directory / "killed");
  }
  fs::remove_all(state);
  fs::rename(directory / "killed", state);
  const auto before = files();
  ASSERT_GT(before.at("state.db-wal").size(), 0u);
  EXPECT_GT(look().lost_results, 1000000u) << "which only the log says";
  EXPECT_EQ(files(), before);
  fs::remove(database.string() + "-shm");
  test::expectError(ExitCode::failed, [&] { look(); }, {"state.db-shm"});
  std::ofstream(database.string() + "-shm");
  EXPECT_GT(look().lost_results, 1000000u) << "because the error explains how";
}

TEST_F(InspectionTest, ReadsAReadOnlyDirectory) {
  const auto read = test::readsUnwritable(state, directory, [&] { return look().whole(); });
  if (!read) GTEST_SKIP() << "NOT TESTED: the user nobody cannot reach " << state;
  EXPECT_TRUE(*read);
}

TEST_F(InspectionTest, AFlippedBitOfARecordLosesItsPointAndIsRepaired) {
  const JournalPosition where = whereIs(first_step);
  const std::string whole = bytesIn(segment), tables = bytesIn(database);
  for (std::uint64_t byte = 0; byte < where.length; byte += 37) {
    flip(segment, where.offset + byte);
    const Inspection found = look();
    ASSERT_THAT(found.damage, SizeIs(1));
    EXPECT_EQ(found.damage[0].where, where);
    EXPECT_THAT(found.damage[0].text, HasSubstr("segment-000001.dat"));
    EXPECT_THAT(describe(found, state), AllOf(HasSubstr("1 result computed again"),
                                              HasSubstr("--repair"), HasSubstr("damaged: ")));
    expectWholeAfterRepair();
    EXPECT_THAT(look().dropped, SizeIs(1));
    EXPECT_FALSE(recorded().recorded.where.contains(first_step));
    putInto(segment, whole);
    putInto(database, tables);
  }
}

TEST_F(InspectionTest, ARepairedBuildEndsAsIfNothingHadHappened) {
  flip(segment, whereIs(first_step).offset + 60);
  flip(segment, whereIs({1, {0, 1, 0}, {0, 0, 0}}).offset + 5);
  expectWholeAfterRepair();
  test::BuildWorld world;
  for (const auto& entry : fs::directory_iterator(state))
    fs::copy_file(entry.path(), world.directory / "state" / entry.path().filename(),
                  fs::copy_options::overwrite_existing);
  world.restart();
  world.join("a", 8);
  world.finish({"a"});
  EXPECT_EQ(world.sealedContent(), undisturbed);
}

TEST_F(InspectionTest, AMissingSegmentLosesItsRecordsAndIsMarked) {
  {
    std::vector<JournalRecord> records;
    const JournalReader reader(state);
    for (const auto& found : test::scanned(reader).records)
      records.push_back(reader.read(found.where));
    fs::remove(segment);
    Journal journal(state, {}, 8000);
    for (const JournalRecord& record : records) journal.append(record.header, record.payload);
    journal.sync();
    ASSERT_GT(journal.end().segment, 2u);
  }
  fs::remove(state / "segment-000002.dat");
  const Inspection found = look();
  ASSERT_THAT(found.damage, SizeIs(1));
  EXPECT_THAT(found.damage[0].text, HasSubstr("segment-000002.dat: is missing"));
  EXPECT_GT(found.lost_results, 1u) << "the tables remember how many there were";
  expectWholeAfterRepair();
}

TEST_F(InspectionTest, ALostTailIsFoundFromTheTables) {
  const std::size_t whole = recorded().results;
  fs::resize_file(segment, fs::file_size(segment) / 2);
  const Inspection found = look();
  EXPECT_FALSE(found.whole()) << describe(found, state);
  EXPECT_THAT(found.damage, IsEmpty());
  EXPECT_GT(found.unfinished, 0u);
  EXPECT_GT(found.lost_results, 5u);
  EXPECT_LT(found.records, whole);
  expectWholeAfterRepair();
  EXPECT_EQ(recorded().results, found.records);
}

/// The state after a power cut: the journal is synced, the tables are not.
TEST_F(InspectionTest, TablesThatLagBehindAreNotDamage) {
  alter("UPDATE meta SET value = 3 WHERE key = 'recorded'");
  const Inspection found = look();
  EXPECT_TRUE(found.whole()) << describe(found, state);
  expectWholeAfterRepair();
}

TEST_F(InspectionTest, DamagedTablesAreRebuiltIfTheirProblemIsReadable) {
  damageRows();
  const Inspection found = look();
  EXPECT_EQ(found.tables, TableState::damaged);
  EXPECT_TRUE(found.problem);
  expectWholeAfterRepair();
  EXPECT_EQ(look().tables, TableState::whole);
  EXPECT_THAT(look().leftovers, ElementsAre(HasSubstr("state.db.damaged")));
  EXPECT_EQ(StoredTables(state).build().build, problemId(problem));
}

TEST_F(InspectionTest, UnreadableTablesAreLeftToTheNextStart) {
  putInto(database, std::string(50000, 'x'));
  EXPECT_EQ(look().tables, TableState::damaged);
  EXPECT_FALSE(look().problem);
  EXPECT_EQ(look().records, recorded().results);
  expectWholeAfterRepair();
  EXPECT_EQ(look().tables, TableState::missing);
}

TEST_F(InspectionTest, ReportsAnyFlippedBitOfTheTables) {
  const std::string bytes = bytesIn(database);
  for (std::size_t byte = 40; byte < bytes.size(); byte += 997) {
    putInto(database, bytes);
    flip(database, byte);
    try {
      const Inspection found = look();
      EXPECT_EQ(found.records, recorded().results);
      EXPECT_EQ(found.damage.size() + found.foreign.size(), 0u);
    } catch (const Error& error) {
      // The damaged byte was part of the version, the build, or the program's mark.
      EXPECT_EQ(error.exitCode(), ExitCode::usage) << byte << ": " << error.what();
    }
  }
}

TEST_F(InspectionTest, ARecordThatLiesAboutItsFieldsIsDamaged) {
  const StateDirectory held(state);
  JournalPosition where;
  {
    auto [header, payload] = test::solve(problem, 0, {}, {});
    payload[0] ^= 1;
    Journal journal(state, recorded().recorded.end);
    where = journal.append(header.SerializeAsString(), payload);
    journal.append("no result", "");
    journal.sync();
  }
  const Inspection found = inspect(held);
  ASSERT_THAT(found.damage, SizeIs(2));
  EXPECT_EQ(found.damage[0].where, where);
  EXPECT_THAT(found.damage[0].text, HasSubstr("content id"));
  EXPECT_THAT(found.damage[1].text, HasSubstr("invalid result"));
  repair(held, found);
  EXPECT_TRUE(inspect(held).whole()) << describe(inspect(held), state);
}

TEST_F(InspectionTest, RecordsOfAnotherBuildAreReportedAndNeverTouched) {
  const Problem other = test::cubeProblem(2000);
  flip(segment, whereIs(first_step).offset + 60);
  append(test::solve(other, 0, {}, {}));
  const auto before = files();
  const Inspection found = look();
  EXPECT_THAT(found.foreign, SizeIs(1));
  EXPECT_FALSE(found.whole());
  const StateDirectory held(state);
  test::expectError(ExitCode::failed, [&] { repair(held, found); },
                    {"another build", "nothing was changed"});
  EXPECT_EQ(bytesIn(segment), before.at("segment-000001.dat"));
}

TEST_F(InspectionTest, UnrequestedResultsAreReportedIfNothingIsLost) {
  append(test::solve(problem, 0, {0, 0, 2}, {0, 0, -1}));
  const Inspection found = look();
  EXPECT_EQ(found.spare, 1u);
  EXPECT_FALSE(found.whole());
  EXPECT_THAT(describe(found, state), HasSubstr("version of palpate"));
}

TEST_F(InspectionTest, ReportsThatASchedulerRunsThere) {
  const StateDirectory held(state);
  alter("UPDATE meta SET value = 1000000 WHERE key = 'recorded'");
  const Inspection found = look();
  EXPECT_EQ(found.scheduler, std::to_string(getpid()));
  EXPECT_TRUE(found.whole()) << "its tables are from another moment";
  EXPECT_THAT(describe(found, state), HasSubstr("process " + std::to_string(getpid())));
}

TEST_F(InspectionTest, RefusesADirectoryWithoutState) {
  fs::create_directory(directory / "empty");
  for (const char* name : {"empty", "missing"})
    test::expectBadInput([&] { inspect(directory / name); }, {name, "not a state directory"});
  EXPECT_TRUE(fs::is_empty(directory / "empty"));
  EXPECT_FALSE(fs::exists(directory / "missing"));
  alter("UPDATE meta SET value = 'palpate 0.0.1' WHERE key = 'made_by'");
  alter("PRAGMA user_version = 2");
  test::expectBadInput([&] { look(); }, {"an older Palpate"});
}

TEST_F(InspectionTest, FindsADirectoryWithoutRecordsUndamaged) {
  const fs::path fresh = directory / "fresh";
  {
    const StateDirectory held(fresh);
    const Tables tables(held, problem);
    EXPECT_TRUE(inspect(held).whole());
  }
  EXPECT_TRUE(inspect(fresh).whole()) << describe(inspect(fresh), fresh);
}

TEST_F(InspectionTest, IsPrintedForProgramsAsOneObject) {
  const JournalPosition rest = whereIs({0, {0, 0, 0}, {0, 0, 0}});
  flip(segment, rest.offset + rest.length - 1);  // in its payload: the key stays readable
  const std::string json = inspectionJson(look(), state, {"a step"});
  EXPECT_THAT(json, HasSubstr("\"build\":\"" + problemId(problem).hex() + "\",\"whole\":false"));
  EXPECT_THAT(json, HasSubstr(R"({"active":"tip","point":{"i":0,"j":0,"k":0},"divisions":)"));
  EXPECT_THAT(json, HasSubstr(R"("repaired":["a step"])"));
  EXPECT_THAT(json, Not(HasSubstr("\n")));
}

/// A repair that was ended after any of its steps gives the same result when repeated.
TEST_F(InspectionTest, AKilledRepairResumes) {
  flip(segment, whereIs(first_step).offset + 60);
  damageRows();
  {
    const StateDirectory held(state);
    const Inspection found = inspect(held);
    Journal journal(state, found.end);
    journal.drop(found.damage.at(0).where);
    putTablesAside(held);
  }
  EXPECT_EQ(look().tables, TableState::missing);
  EXPECT_TRUE(look().problem) << "from the tables that were moved aside";
  expectWholeAfterRepair();
  EXPECT_EQ(look().tables, TableState::whole);
}

}  // namespace
}  // namespace palpate
