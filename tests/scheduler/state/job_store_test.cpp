#include "scheduler/state/job_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <fstream>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/child.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/file_bytes.hpp"
#include "tests/support/unwritable.hpp"

namespace palpate {
namespace {

struct JobStoreTest : testing::Test {
  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  const std::filesystem::path state = directory / "state";
  const std::filesystem::path segment = state / "segment-000001.dat";

  JobStore open(const StateDirectory& held) { return {held, problem}; }

  std::pair<wire::Result, std::string> result(std::uint32_t space, const LatticePoint& target,
                                              const LatticePoint& parent) {
    return test::solve(problem, space, target, parent);
  }
  /// The origin and its neighbours along x, of space 0.
  void recordThree() {
    const StateDirectory held(state);
    JobStore store = open(held);
    for (const LatticePoint& target : {LatticePoint{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}}) {
      const auto [header, payload] = result(0, target, {0, 0, 0});
      store.append(header, payload);
    }
    store.commit();
  }
  void flip(std::uint64_t byte) const { test::flip(segment, byte); }
  RecordedResults found() {
    return readResults(state, problemId(problem), [](auto&&...) {});
  }
  JournalPosition whereIs(const ResultKey& key) { return found().where.at(key); }
};

TEST_F(JobStoreTest, ReturnsResultsToTheLastBitAfterReopening) {
  auto [header, payload] = result(0, {}, {});
  const double minus_zero = -0.0;
  header.mutable_equilibrium()->set_energy(minus_zero);
  {
    const StateDirectory held(state);
    JobStore store = open(held);
    EXPECT_EQ(store.kernelFamily(), "");
    store.append(header, payload);
    EXPECT_FALSE(store.knows({0, {}, {}})) << "it is not synced yet";
    store.commit();
    EXPECT_TRUE(store.knows({0, {}, {}}));
  }
  const StateDirectory held(state);
  JobStore store = open(held);
  EXPECT_EQ(store.kernelFamily(), "baseline");
  ASSERT_EQ(store.found(), 1u);
  const auto found = store.read({0, {}, {}});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->SerializeAsString(), header.SerializeAsString());
  EXPECT_TRUE(std::signbit(fromWire(*found)->equilibrium().energy));
  EXPECT_TRUE(std::signbit(store.takeReplay().plans[0].points().equilibrium(0).energy));
  EXPECT_EQ(store.find({0, {}, {}})->payload, payload);
  EXPECT_FALSE(store.find({0, {1, 0, 0}, {}}));
  EXPECT_FALSE(store.find({1, {}, {}}));
}

TEST_F(JobStoreTest, ADamagedHeaderLosesOnlyItsResult) {
  recordThree();
  flip(whereIs({0, {1, 0, 0}, {}}).offset + 40);
  const StateDirectory held(state);
  JobStore store = open(held);
  EXPECT_TRUE(store.damaged());
  EXPECT_EQ(store.found(), 2u);
  EXPECT_FALSE(store.knows({0, {1, 0, 0}, {}}));
}

TEST_F(JobStoreTest, ADroppedResultIsGoneAndCanBeRecordedAgain) {
  recordThree();
  const ResultKey key{0, {1, 0, 0}, {}};
  const auto [header, payload] = result(0, key.target, key.parent);
  {
    const StateDirectory held(state);
    JobStore store = open(held);
    const JournalPosition where = whereIs(key);
    flip(where.offset + where.length - 1);
    try {
      store.find(key);
      ADD_FAILURE() << "damage went unnoticed";
    } catch (const DamagedRecord& damage) {
      EXPECT_EQ(damage.where(), where);
      store.drop(damage.where());
    }
  }
  const StateDirectory held(state);
  JobStore store = open(held);
  EXPECT_TRUE(store.damaged());
  EXPECT_FALSE(store.knows(key));
  store.append(header, payload);
  store.commit();
  EXPECT_EQ(store.find(key)->payload, payload);
  EXPECT_EQ(found().where.size(), 3u);
}

/// A power cut may keep any sectors of unsynced data. In the last segment that is detected, because
/// all of it is read; the record must not return as a result when another segment is the last.
TEST_F(JobStoreTest, ATornRecordStaysGoneWhenAnotherSegmentBegins) {
  recordThree();
  const ResultKey key{0, {1, 0, 0}, {}};
  const JournalPosition torn = whereIs(key);
  flip(torn.offset + torn.length - 1);
  const StateDirectory held(state);
  {
    JobStore store(held, problem, 1);
    EXPECT_FALSE(store.knows(key));
    const auto [header, payload] = result(0, key.target, key.parent);
    store.append(header, payload);
    store.commit();
  }
  const RecordedResults after = found();
  const JournalPosition again = after.where.at(key);
  EXPECT_EQ(again.segment, 2u);
  EXPECT_NO_THROW(JournalReader(state).read(again));
}

TEST_F(JobStoreTest, ReplacesTablesMarkedAsReadOnly) {
  recordThree();
  std::fstream file(StateDirectory::databaseIn(state),
                    std::ios::binary | std::ios::in | std::ios::out);
  constexpr std::streamoff write_version = 18;  // in SQLite's header; above 2 it is read-only
  file.seekp(write_version);
  file.put(3);
  file.close();
  const StateDirectory held(state);
  EXPECT_EQ(open(held).found(), 3u);
  EXPECT_TRUE(std::filesystem::exists(state / "state.db.damaged"));
}

TEST_F(JobStoreTest, TheTablesCanBeRebuiltFromTheJournal) {
  recordThree();
  for (const char* what : {"removed", "overwritten", "cut off"}) {
    const std::filesystem::path file = StateDirectory::databaseIn(state);
    if (std::string(what) == "removed") std::filesystem::remove(file);
    if (std::string(what) == "overwritten") std::ofstream(file) << std::string(50000, 'x');
    if (std::string(what) == "cut off")
      std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    const StateDirectory held(state);
    JobStore store = open(held);
    EXPECT_EQ(store.found(), 3u) << what;
    EXPECT_EQ(problemId(decodeProblem(StoredTables(state).build().problem)), problemId(problem));
  }
}

TEST_F(JobStoreTest, AnImpossibleWordInTheTablesIsDamage) {
  recordThree();
  const auto damage = [&](const char* sql) {
    Database tables(state / "state.db", Database::Access::read_write_create);
    tables.execute(std::string("PRAGMA ignore_check_constraints = ON; ") + sql);
  };
  const auto putAside = [&] {
    const StateDirectory held(state);
    JobStore store = open(held);
    EXPECT_EQ(store.found(), 3u);
    return std::filesystem::remove(state / "state.db.damaged");
  };
  damage("INSERT INTO kept_out VALUES ('nobody', x'01', 'node1', x'02', 'it lied')");
  EXPECT_TRUE(putAside()) << "the exclusions are needed";
  damage("INSERT INTO servers VALUES ('0a', 'node1', 1, 'avx2', 'asleep', 0, 0)");
  EXPECT_TRUE(putAside());
}

TEST_F(JobStoreTest, NoFlippedBitOfTheTablesReachesAResult) {
  recordThree();
  std::map<ResultKey, std::string> whole;
  readResults(state, problemId(problem),
              [&](const ResultKey& key, const wire::Result& result, const Outcome&) {
                whole[key] = result.SerializeAsString();
              });
  const std::filesystem::path file = StateDirectory::databaseIn(state);
  const std::string bytes = test::bytesIn(file);
  std::vector<std::pair<std::size_t, int>> flips;  // byte, bit
  for (std::size_t byte = 0; byte < bytes.size(); byte += 997) flips.emplace_back(byte, 4);
  const auto everyBit = [&](std::size_t first, std::size_t count) {
    for (std::size_t byte = first; byte < first + count; ++byte)
      for (int bit = 0; bit < 8; ++bit) flips.emplace_back(byte, bit);
  };
  everyBit(60, 12);  // the versions and the program's mark in SQLite's header
  const std::size_t build = bytes.find(problemId(problem).hex());
  ASSERT_NE(build, std::string::npos);
  everyBit(build, 8);
  for (const auto& [byte, bit] : flips) {
    SCOPED_TRACE(fmt::format("bit {} of byte {}", bit, byte));
    test::putInto(file, bytes);
    test::flip(file, byte, 1 << bit);
    std::filesystem::remove(file.string() + "-wal");
    const StateDirectory held(state);
    JobStore store = open(held);
    for (const auto& [key, header] : whole) {
      ASSERT_TRUE(store.knows(key));
      EXPECT_EQ(store.read(key)->SerializeAsString(), header);
    }
  }
}

/// The stored progress would count results that no longer exist.
TEST_F(JobStoreTest, ForgetsItsProgressWhenAResultIsDropped) {
  recordThree();
  const StateDirectory held(state);
  JobStore store = open(held);
  EXPECT_EQ(store.recorded(), 3u);
  store.tables().writeProgress({store.recorded(), "complete"});
  store.drop(std::vector<ResultKey>());
  EXPECT_TRUE(StoredTables(state).progress());
  store.drop(std::vector<ResultKey>{{0, {}, {}}});
  EXPECT_EQ(store.recorded(), 2u);
  EXPECT_FALSE(StoredTables(state).progress());
}

TEST_F(JobStoreTest, RemembersOnWhichTransitionsWorkersEnded) {
  const Tables::NumberedTransition key{1, {5, 2}};
  {
    const StateDirectory held(state);
    open(held).tables().writeLosses(key, {7, 4, 5});
  }
  {
    const StateDirectory held(state);
    EXPECT_EQ(open(held).tables().losses().at(key), (Losses{7, 4, 5}));
    EXPECT_EQ(Tables(held).forgetLosses(), 1) << "as many were set aside";
  }
  const StateDirectory held(state);
  EXPECT_TRUE(open(held).tables().losses().empty());
}

TEST_F(JobStoreTest, ContinuesCountingFromAnyValueInTheTables) {
  recordThree();
  {
    Database tables(state / "state.db", Database::Access::read_write_create);
    tables.execute(
        "INSERT OR REPLACE INTO counters VALUES ('runs', 9223372036854775807);"
        "INSERT OR REPLACE INTO counters VALUES ('lost_workers', -5);"
        "INSERT OR REPLACE INTO meta VALUES ('recorded', 9223372036854775807);"
        "INSERT INTO losses VALUES (0, 1, 0, 4294967295, 2147483647, -2147483648)");
  }
  const StateDirectory held(state);
  JobStore store = open(held);
  EXPECT_EQ(store.found(), 3u) << "there is room for what the journal can hold";
  for (const auto& [name, value] : store.tables().counters()) {
    EXPECT_GE(value, 0) << name;
    EXPECT_LT(value, std::numeric_limits<std::int32_t>::max()) << name;
  }
  const Losses losses = store.tables().losses().at({0, {1, 0}});
  EXPECT_LT(losses.attempts, 4294967295u);
  EXPECT_GT(losses.suspected, 0);
  EXPECT_LT(losses.suspected, 2147483647);
  EXPECT_EQ(losses.deaths, 0);
}

TEST_F(JobStoreTest, RefusesTheDirectoryOfAnotherScene) {
  recordThree();
  const Problem other = test::cubeProblem(2000);
  const auto openOther = [&] {
    const StateDirectory held(state);
    JobStore(held, other);
  };
  test::expectBadInput(openOther,
                       {"scene \"cube\"", problemId(problem).shortHex(), "another --state"});
  std::filesystem::remove(StateDirectory::databaseIn(state));
  test::expectBadInput(openOther, {"another build", problemId(problem).shortHex()});
}

TEST_F(JobStoreTest, RefusesOtherVersionsAndOtherDatabases) {
  { open(StateDirectory(state)); }
  const auto alter = [&](const std::string& sql) {
    Database(StateDirectory::databaseIn(state), Database::Access::read_write_create).execute(sql);
  };
  alter("UPDATE meta SET value = 'palpate 0.0.1' WHERE key = 'made_by'");
  alter("PRAGMA user_version = 2");
  test::expectBadInput([&] { open(StateDirectory(state)); },
                       {"an older Palpate", "version 2", "continue with the older version"});
  test::expectBadInput([&] { const StoredTables tables{state}; }, {"an older Palpate"});
  // A version before the first release.
  alter("UPDATE meta SET value = 'palpate 0.1.0' WHERE key = 'made_by'");
  alter("PRAGMA user_version = 5");
  test::expectBadInput([&] { open(StateDirectory(state)); }, {"an older Palpate", "version 5"});
  alter("PRAGMA user_version = 99");
  test::expectBadInput([&] { open(StateDirectory(state)); }, {"newer Palpate", "99"});
  alter("PRAGMA application_id = 1");
  alter("UPDATE meta SET value = 'somebody' WHERE key = 'made_by'");
  test::expectBadInput([&] { open(StateDirectory(state)); }, {"database of another program"});
  alter("DROP TABLE meta");
  test::expectBadInput([&] { open(StateDirectory(state)); }, {"database of another program"});
}

/// A power cut has left only the first page of the database on disk.
TEST_F(JobStoreTest, CreatesItsTablesInAnEmptyDatabaseWhateverItsHeader) {
  recordThree();
  const std::filesystem::path file = StateDirectory::databaseIn(state);
  for (const char* part : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + part);
  Database(file, Database::Access::read_write_create).execute("PRAGMA schema_version = 1073741824");
  const StateDirectory held(state);
  EXPECT_EQ(open(held).found(), 3U);
}

TEST_F(JobStoreTest, RefusesAFileThatIsNotADatabaseWithoutAJournal) {
  std::filesystem::create_directories(state);
  std::ofstream(StateDirectory::databaseIn(state)) << std::string(5000, 'x');
  test::expectError(ExitCode::failed, [&] { open(StateDirectory(state)); },
                    {"state.db", "not a database"});
}

TEST_F(JobStoreTest, CanBeReadWhileASchedulerWrites) {
  const StateDirectory held(state);
  JobStore store = open(held);
  wire::WorkerStatus worker;
  worker.set_worker("abcdef0123");
  worker.set_state("busy");
  worker.set_heard_seconds_ago(3);
  store.tables().writeServers(std::vector{worker});
  store.tables().writeCounters({{"runs", 2}});
  StoredTables tables(state);
  const auto [header, payload] = result(0, {}, {});
  store.append(header, payload);
  store.commit();
  store.tables().writeCounters({{"runs", 3}});
  EXPECT_EQ(tables.counters()["runs"], 2) << "a snapshot of the moment it was opened";
  EXPECT_EQ(found().where.size(), 1u);
  ASSERT_EQ(tables.servers().size(), 1u);
  EXPECT_EQ(tables.servers()[0].state(), "busy");
  EXPECT_NEAR(tables.servers()[0].heard_seconds_ago(), 3, 60);
  EXPECT_EQ(problemId(decodeProblem(tables.build().problem)), problemId(problem));
}

TEST_F(JobStoreTest, KeepsRowsOfDeliveringWorkersAndTheLatestOthers) {
  const StateDirectory held(state);
  JobStore store = open(held);
  const auto rowsOf = [](int first, int count, int results) {
    std::vector<wire::WorkerStatus> rows(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      wire::WorkerStatus& row = rows[static_cast<std::size_t>(i)];
      row.set_worker(fmt::format("{:02}-{:06}", results, first + i));
      row.set_state("left");
      row.set_results(results);
    }
    return rows;
  };
  constexpr int most = Tables::most_idle_departed;
  store.tables().writeServers(rowsOf(0, 2 * most, 1));
  for (int round = 0; round < 5; ++round)
    store.tables().writeServers(rowsOf(round * most, most, 0));
  const auto rows = StoredTables(state).servers();
  ASSERT_EQ(rows.size(), static_cast<std::size_t>(3 * most));
  EXPECT_TRUE(std::ranges::any_of(
      rows, [](const auto& row) { return row.worker() == fmt::format("00-{:06}", 5 * most - 1); }));
}

/// SQLite itself cannot read a database in WAL mode in a read-only directory.
TEST_F(JobStoreTest, CanBeReadInAReadOnlyDirectory) {
  recordThree();
  const auto read = test::readsUnwritable(state, directory, [&] {
    return problemId(decodeProblem(StoredTables(state).build().problem)) == problemId(problem) &&
           found().where.size() == 3 && !StateDirectory::liveAddress(state);
  });
  if (!read) GTEST_SKIP() << "NOT TESTED: the user nobody cannot reach " << state;
  EXPECT_TRUE(*read);
}

TEST_F(JobStoreTest, SaysWhenADirectoryHoldsNoState) {
  test::expectBadInput([&] { const StoredTables tables{directory.path()}; },
                       {"not a state directory"});
}

TEST_F(JobStoreTest, IsAccessibleToItsOwnerOnly) {
  recordThree();
  for (const auto& file : {state, segment, StateDirectory::databaseIn(state), state / "lock"})
    EXPECT_EQ(std::filesystem::status(file).permissions() & std::filesystem::perms(077),
              std::filesystem::perms::none)
        << file;
}

TEST(StateDirectory, AdmitsOnlyOneScheduler) {
  test::TemporaryDirectory directory;
  const StateDirectory first(directory / "state");
  test::expectError(ExitCode::failed, [&] { StateDirectory(directory / "state"); },
                    {"in use by process", std::to_string(getpid())});
}

TEST(StateDirectory, AdmitsNoSecondSchedulerIfItsLockFileWasRemoved) {
  test::TemporaryDirectory directory;
  const StateDirectory first(directory / "state");
  std::filesystem::remove(directory / "state/lock");
  test::expectError(ExitCode::failed, [&] { StateDirectory(directory / "state"); },
                    {"in use by process"});
}

TEST(StateDirectory, NoticesThatItWasRemovedOrReplaced) {
  test::TemporaryDirectory directory;
  const StateDirectory held(directory / "state");
  held.checkPresence();
  std::filesystem::rename(directory / "state", directory / "aside");
  test::expectError(ExitCode::failed, [&] { held.checkPresence(); }, {"removed or replaced"});
  std::filesystem::create_directory(directory / "state");
  test::expectError(ExitCode::failed, [&] { held.checkPresence(); }, {"removed or replaced"});
}

TEST(StateDirectory, CreatesNoFoldersForAMistypedName) {
  test::TemporaryDirectory directory;
  test::expectError(ExitCode::failed, [&] { StateDirectory(directory / "typo/state/"); },
                    {(directory / "typo").string() + ": create", "--state"});
  EXPECT_FALSE(std::filesystem::exists(directory / "typo"));
}

TEST(StateDirectory, TellsWhereItsSchedulerListensWhileItRuns) {
  test::TemporaryDirectory directory;
  EXPECT_FALSE(StateDirectory::liveAddress(directory.path()));
  {
    const StateDirectory held(directory.path());
    held.announce({"tcp://127.0.0.1:1234", {}});
    EXPECT_EQ(StateDirectory::liveAddress(directory.path())->endpoint, "tcp://127.0.0.1:1234");
    EXPECT_FALSE(StateDirectory::liveAddress(directory.path())->keys);
    held.announce({"tcp://127.0.0.1:1234", KeyFolder(held.keys())});
    EXPECT_EQ(StateDirectory::liveAddress(directory.path())->keys.value().path(), held.keys());
  }
  EXPECT_FALSE(StateDirectory::liveAddress(directory.path()));
}

TEST(StateDirectory, KnowsNetworkFileSystems) {
  EXPECT_STREQ(networkFileSystem(0x6969), "NFS");
  EXPECT_STREQ(networkFileSystem(0x0BD00BD0), "Lustre");
  EXPECT_STREQ(networkFileSystem(0x65735546), "FUSE");
  EXPECT_STREQ(networkFileSystem(0x01021997), "9p");
  EXPECT_EQ(networkFileSystem(0xEF53), nullptr);
}

/// The child commits one result, appends another without a sync, and is killed before either is
/// acknowledged. The committed record survives.
TEST(Recovery, AKillBetweenAppendAndCommitLosesNothingAcknowledged) {
  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  const pid_t child = test::startChild([&] {
    const StateDirectory held(directory / "state");
    JobStore store(held, problem);
    for (const std::uint32_t space : {0u, 1u}) {
      const auto [header, payload] = test::solve(problem, space, {}, {});
      store.append(header, payload);
      if (space == 0) store.commit();
    }
    return kill(getpid(), SIGKILL);
  });
  ASSERT_EQ(test::codeOf(child), -SIGKILL);

  const StateDirectory held(directory / "state");
  JobStore store(held, problem);
  EXPECT_FALSE(store.damaged());
  EXPECT_EQ(store.found(), 1u) << "the other result was not acknowledged";
  EXPECT_EQ(store.find({0, {}, {}})->payload, test::solve(problem, 0, {}, {}).second);
}

}  // namespace
}  // namespace palpate
