#include "scheduler/state/job_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <fstream>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

struct JobStoreTest : testing::Test {
  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  const Lattice lattice{0.02, 0.01};
  const std::filesystem::path state = directory / "state";

  JobStore open(const StateDirectory& held) { return {held, problem, encodeProblem(problem)}; }

  StoredResult result(std::uint32_t space, std::int32_t target, std::int32_t parent) {
    StoredResult stored;
    stored.key = {space, target, parent};
    stored.header = test::solve(problem, space, lattice.point(target), lattice.point(parent)).first;
    stored.outcome = *fromWire(stored.header);
    stored.where = {1, 100, 50};
    return stored;
  }
  void alter(const std::string& sql) {
    Database(StateDirectory::databaseIn(state), Database::Access::read_write_create).execute(sql);
  }
};

TEST_F(JobStoreTest, BeginsWithEveryPointUnknown) {
  const StateDirectory held(state);
  JobStore store = open(held);
  EXPECT_EQ(store.committed(), JournalEnd());
  EXPECT_TRUE(store.results().empty());
  EXPECT_FALSE(store.build().complete);
  Database database(held.database(), Database::Access::read_only);
  Statement count(database, "SELECT COUNT(*) FROM configurations WHERE tag = 'unknown'");
  ASSERT_TRUE(count.step());
  EXPECT_EQ(count.integer(0), 2 * lattice.size());
}

TEST_F(JobStoreTest, GivesBackResultsToTheLastBitAfterReopening) {
  StoredResult origin = result(0, 0, 0);
  const double minus_zero = -0.0;
  origin.header.mutable_equilibrium()->set_energy(minus_zero);
  {
    const StateDirectory held(state);
    JobStore store = open(held);
    const std::vector<StoredResult> results = {origin};
    store.record(results, {2, 777});
  }
  const StateDirectory held(state);
  JobStore store = open(held);
  EXPECT_EQ(store.committed(), (JournalEnd{2, 777}));
  EXPECT_EQ(store.build().kernel_family, "baseline");
  const auto found = store.find({0, 0, 0});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->header.SerializeAsString(), origin.header.SerializeAsString());
  EXPECT_TRUE(std::signbit(found->outcome.equilibrium.energy));
  EXPECT_EQ(found->where, origin.where);
  EXPECT_FALSE(store.find({0, 1, 0}));
  EXPECT_FALSE(store.find({1, 0, 0}));
}

TEST_F(JobStoreTest, KeepsTheOrderInWhichAPointWasTried) {
  const StateDirectory held(state);
  JobStore store = open(held);
  std::vector<StoredResult> results;
  for (const std::int32_t parent : {7, 3, 5}) {
    results.push_back(result(1, 20, parent));
    Outcome failed;
    failed.failure.cause = Cause::step_budget;
    results.back().header.clear_equilibrium();
    results.back().header.clear_fields_id();
    toWire(failed, "", results.back().header);
    results.back().outcome = failed;
  }
  store.record(results, {1, 150});
  std::vector<std::int32_t> parents;
  for (const StoredResult& stored : store.results()) parents.push_back(stored.key.parent);
  EXPECT_THAT(parents, testing::ElementsAre(7, 3, 5));
  EXPECT_TRUE(store.find({1, 20, 3}));
}

TEST_F(JobStoreTest, KeepsAnotherEquilibriumOfASolvedPointBesideIt) {
  const StateDirectory held(state);
  JobStore store = open(held);
  StoredResult first = result(0, 20, 7), second = first;
  ASSERT_TRUE(first.outcome.converged);
  second.key.parent = 3;
  *second.header.mutable_parent() = toWire(lattice.point(3));
  store.record(std::vector<StoredResult>{first}, {1, 150});
  store.record(std::vector<StoredResult>{second}, {1, 150});
  const std::vector<StoredResult> results = store.results();
  ASSERT_EQ(results.size(), 2u);
  EXPECT_EQ(results[0].key, first.key);
  EXPECT_EQ(results[1].key, second.key);
  EXPECT_TRUE(results[1].outcome.converged);
  EXPECT_TRUE(store.find(second.key));
}

TEST_F(JobStoreTest, TakesPointsThatAreNotInTheUniformLattice) {
  const StateDirectory held(state);
  JobStore store = open(held);
  StoredResult refined = result(0, 7, 0);
  refined.key.target = 1234;
  *refined.header.mutable_target() = toWire({512, 0, -512});
  store.record(std::vector<StoredResult>{refined}, {1, 150});
  ASSERT_TRUE(store.find(refined.key));
  EXPECT_EQ(store.results().at(0).key, refined.key);
}

TEST_F(JobStoreTest, RecordsAGroupWhollyOrNotAtAll) {
  const StateDirectory held(state);
  JobStore store = open(held);
  const std::vector<StoredResult> twice = {result(0, 0, 0), result(0, 0, 0)};
  test::expectError(ExitCode::failed,
                    [&] {
                      store.record(twice, {1, 500});
                    },
                    {"point 0 of space 0", "twice"});
  EXPECT_TRUE(store.results().empty());
  EXPECT_EQ(store.committed(), JournalEnd());
}

TEST_F(JobStoreTest, ShowsEveryPointAsItsPlanLeavesItAtTheEnd) {
  const StateDirectory held(state);
  JobStore store = open(held);
  SpacePlan plan(problem, 0);
  plan.takeReady();
  Outcome failed;
  failed.failure.cause = Cause::wrong_inertia;
  plan.record({0, 0}, failed, {});
  store.complete(std::vector<SpacePlan>{plan});
  EXPECT_TRUE(store.build().complete);
  Database database(held.database(), Database::Access::read_only);
  Statement query(database,
                  "SELECT cause, COUNT(*) FROM configurations WHERE tag = 'failed' GROUP BY cause "
                  "ORDER BY cause DESC");
  ASSERT_TRUE(query.step());
  EXPECT_EQ(query.text(0), "wrong_inertia");
  EXPECT_EQ(query.integer(1), 1);
  ASSERT_TRUE(query.step());
  EXPECT_EQ(query.text(0), "unreachable");
  EXPECT_EQ(query.integer(1), lattice.size() - 1);
}

TEST_F(JobStoreTest, ShowsPeopleWhatAPointIsAndWhereItCameFrom) {
  const StateDirectory held(state);
  JobStore store = open(held);
  const StoredResult solved = result(0, 0, 0);
  store.record(std::vector<StoredResult>{solved}, {1, 150});
  Database database(held.database(), Database::Access::read_only);
  Statement query(database,
                  "SELECT i, tag, parent, force, factorizations, cause FROM configurations "
                  "WHERE space = 0 AND point IN (0, 1) ORDER BY point");
  ASSERT_TRUE(query.step());
  EXPECT_EQ(query.text(1), "expandable");
  EXPECT_EQ(query.integer(2), 0);
  EXPECT_EQ(query.real(3), solved.outcome.equilibrium.force.norm());
  EXPECT_EQ(query.integer(4), solved.outcome.cost.factorizations);
  EXPECT_EQ(query.text(5), "none");
  ASSERT_TRUE(query.step());
  EXPECT_EQ(query.text(1), "unknown");
  EXPECT_EQ(query.integer(2), -1);
}

TEST_F(JobStoreTest, RefusesTheDirectoryOfAnotherScene) {
  { open(StateDirectory(state)); }
  const Problem other = test::cubeProblem(2000);
  const StateDirectory held(state);
  test::expectBadInput([&] { JobStore(held, other, encodeProblem(other)); },
                       {"scene \"cube\"", problemId(problem).shortHex(), "another --state"});
}

TEST_F(JobStoreTest, RefusesOtherVersionsAndOtherDatabases) {
  { open(StateDirectory(state)); }
  alter("PRAGMA user_version = 2");
  test::expectBadInput([&] { open(StateDirectory(state)); },
                       {"an older Palpate", "version 2", "go on with the older one"});
  test::expectBadInput([&] { StoredTables(state).results(); }, {"an older Palpate"});
  alter("PRAGMA user_version = 99");
  test::expectBadInput([&] { open(StateDirectory(state)); }, {"newer Palpate", "99"});
  alter("PRAGMA application_id = 1");
  test::expectBadInput([&] { open(StateDirectory(state)); }, {"not one of Palpate's"});
}

TEST_F(JobStoreTest, RefusesAFileThatIsNoDatabase) {
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
  store.writeServers(std::vector{worker});
  store.writeCounters({{"runs", 2}});
  StoredTables tables(state);
  const std::vector<StoredResult> results = {result(0, 0, 0)};
  store.record(results, {1, 150});
  EXPECT_TRUE(tables.results().empty()) << "a snapshot of the moment it was opened";
  EXPECT_EQ(StoredTables(state).results().size(), 1u);
  ASSERT_EQ(tables.servers().size(), 1u);
  EXPECT_EQ(tables.servers()[0].state(), "busy");
  EXPECT_NEAR(tables.servers()[0].heard_seconds_ago(), 3, 60);
  EXPECT_EQ(tables.counters()["runs"], 2);
  EXPECT_EQ(problemId(decodeProblem(tables.build().problem)), problemId(problem));
}

TEST_F(JobStoreTest, SaysWhenADirectoryHoldsNoState) {
  test::expectBadInput([&] { StoredTables(directory.path()); }, {"not a state directory"});
}

TEST(StateDirectory, LetsOnlyOneSchedulerIn) {
  test::TemporaryDirectory directory;
  const StateDirectory first(directory / "state");
  test::expectError(ExitCode::failed, [&] { StateDirectory(directory / "state"); },
                    {"in use by process", std::to_string(getpid())});
}

TEST(StateDirectory, DoesNotMakeTheFoldersOfAMistypedName) {
  test::TemporaryDirectory directory;
  test::expectError(ExitCode::failed, [&] { StateDirectory(directory / "typo/state/"); },
                    {(directory / "typo").string() + " to make it in", "--state"});
  EXPECT_FALSE(std::filesystem::exists(directory / "typo"));
}

TEST(StateDirectory, TellsWhereItsSchedulerListensAsLongAsItLives) {
  test::TemporaryDirectory directory;
  EXPECT_FALSE(StateDirectory::liveEndpoint(directory.path()));
  {
    const StateDirectory held(directory.path());
    held.announce("tcp://127.0.0.1:1234");
    EXPECT_EQ(StateDirectory::liveEndpoint(directory.path()), "tcp://127.0.0.1:1234");
  }
  EXPECT_FALSE(StateDirectory::liveEndpoint(directory.path()));
}

TEST(StateDirectory, KnowsNetworkFileSystems) {
  EXPECT_STREQ(networkFileSystem(0x6969), "NFS");
  EXPECT_STREQ(networkFileSystem(0x0BD00BD0), "Lustre");
  EXPECT_EQ(networkFileSystem(0xEF53), nullptr);
}

/// Dies right after the journal was synced, before the transaction, and right after the
/// transaction, before the acknowledgement: what was committed is there, what was not is asked for
/// again.
TEST(Recovery, AKillBetweenJournalAndTransactionLosesNothingAcknowledged) {
  test::TemporaryDirectory directory;
  const Problem problem = test::cubeProblem();
  const Lattice lattice(0.02, 0.01);
  const auto origin = [&](std::uint32_t space) {
    StoredResult stored{
        {space, 0, 0}, test::solve(problem, space, {0, 0, 0}, {0, 0, 0}).first, {}, {}};
    stored.outcome = *fromWire(stored.header);
    return stored;
  };
  const std::string fields = test::solve(problem, 0, {0, 0, 0}, {0, 0, 0}).second;
  const pid_t child = fork();
  if (child == 0) {
    const StateDirectory held(directory / "state");
    JobStore store(held, problem, encodeProblem(problem));
    Journal journal(held.path(), store.committed());
    std::vector<StoredResult> first = {origin(0)};
    first[0].where = journal.append(first[0].header.SerializeAsString(), fields);
    journal.sync();
    store.record(first, journal.end());
    journal.append(origin(1).header.SerializeAsString(), fields);
    journal.sync();
    kill(getpid(), SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));

  const StateDirectory held(directory / "state");
  JobStore store(held, problem, encodeProblem(problem));
  ASSERT_GT(std::filesystem::file_size(directory / "state/segment-000001.dat"),
            store.committed().offset);
  Journal journal(held.path(), store.committed());
  EXPECT_EQ(std::filesystem::file_size(directory / "state/segment-000001.dat"),
            store.committed().offset);
  ASSERT_EQ(store.results().size(), 1u);
  EXPECT_EQ(journal.read(store.results()[0].where).payload, fields);
}

}  // namespace
}  // namespace palpate
