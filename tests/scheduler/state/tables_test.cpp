#include "scheduler/state/tables.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <limits>
#include <set>

#include "tests/support/expect_error.hpp"
#include "tests/support/solved_table.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using testing::ElementsAre;
using testing::Pair;
using testing::SizeIs;
using Changed = Tables::Changed;

/// What a worker answers: a spring, which is solved from three neighbours of four, but for some
/// points, and not within max_force at the edge of the ball.
Outcome springOutcome(const SpacePlan& plan, const Transition& transition) {
  const auto [target, parent] = transition;
  Outcome outcome;
  outcome.cost = {4, 1 + target % 5, 1, 0.25};
  outcome.converged = target == 0 || (target % 6 != 5 && (7 * target + 3 * parent) % 4 != 0);
  outcome.failure.cause = outcome.converged ? Cause::none : Cause::step_budget;
  if (!outcome.converged) return outcome;
  const double stiffness = plan.patch().name == "tip" ? 450 : 460;  // N/m
  const Eigen::Vector3d p = plan.positions().displacement(target);
  outcome.equilibrium.force = -stiffness * p;
  outcome.equilibrium.stiffness = -stiffness * Eigen::Matrix3d::Identity();
  outcome.equilibrium.energy = stiffness * p.squaredNorm() / 2;
  return outcome;
}

/// Tables of a build of two spaces with 33 points each, to which probes are added.
struct TablesTest : testing::Test {
  test::TemporaryDirectory directory;
  const Problem problem = [] {
    Problem made = test::cubeProblem();
    made.scene.accuracy.probes = 5;
    return made;
  }();
  const StateDirectory held{directory / "state"};

  Tables open() { return {held, problem, encodeProblem(problem)}; }

  /// So many results later, of each of them.
  std::vector<SpacePlan> plansAfter(int results) const {
    std::vector<SpacePlan> plans;
    for (std::uint32_t space = 0; space < 2; ++space)
      solveSome(plans.emplace_back(problem, space), results);
    return plans;
  }
  std::vector<SpacePlan> plansAtFirst() const { return plansAfter(0); }
  std::vector<SpacePlan> plansAtTheEnd() const { return plansAfter(1000); }
  static void solveSome(SpacePlan& plan, int results) {
    std::vector<Transition> ready = plan.takeReady();
    for (std::size_t n = 0; n < ready.size() && results > 0; ++n, --results) {
      const Transition next = ready[n];
      plan.record(next, springOutcome(plan, next), ContentId::of(std::to_string(next.target)));
      for (const Transition& more : plan.takeReady()) ready.push_back(more);
    }
  }

  /// What anybody reads there by now.
  std::vector<PointRow> shown() const {
    std::vector<PointRow> rows;
    StoredTables(held.path()).eachPoint([&](const PointRow& row) { rows.push_back(row); });
    return rows;
  }
  static std::vector<PointRow> rowsFor(const std::vector<SpacePlan>& plans) {
    std::vector<PointRow> rows;
    for (std::uint32_t space = 0; space < plans.size(); ++space)
      for (std::int32_t n = 0; n < plans[space].size(); ++n)
        rows.push_back(rowOf(space, n, plans[space]));
    return rows;
  }
  /// What is to be seen when so many points of `now` were shown, one by one, where `before` was.
  static std::vector<PointRow> midway(const std::vector<SpacePlan>& before,
                                      const std::vector<SpacePlan>& now, std::int32_t done) {
    std::vector<PointRow> rows;
    for (std::uint32_t space = 0; space < now.size(); ++space) {
      const std::int32_t size = now[space].size(), shown = std::clamp(done, 0, size);
      done -= size;
      for (std::int32_t n = 0; n < shown; ++n) rows.push_back(rowOf(space, n, now[space]));
      const std::int32_t end = shown == size ? size : before[space].size();
      for (std::int32_t n = shown; n < end; ++n) rows.push_back(rowOf(space, n, before[space]));
    }
    return rows;
  }
  void alter(const std::string& sql) const {
    Database(held.database(), Database::Access::read_write_create).execute(sql);
  }
};

TEST_F(TablesTest, ShowEachPointAsItsPlanHasIt) {
  std::vector<SpacePlan> plans = plansAfter(25);
  open().showAll(plans);
  const std::vector<PointRow> rows = shown();
  ASSERT_EQ(std::ssize(rows), plans[0].size() + plans[1].size());
  std::set<std::string> tags;
  for (const PointRow& row : rows) {
    const SpacePlan& plan = plans.at(row.space);
    const PointRecord point = plan.point(row.number);
    EXPECT_EQ(row.position, plan.positions().point(row.number));
    EXPECT_EQ(row.tag, name(point.tag));
    EXPECT_EQ(row.cause, name(point.cause));
    EXPECT_EQ(row.parent, point.parent);
    EXPECT_EQ(row.factorizations, point.cost.factorizations);
    EXPECT_EQ(row.force,
              isSolved(point.tag) ? std::optional(point.equilibrium.force.norm()) : std::nullopt);
    tags.insert(row.tag);
  }
  EXPECT_THAT(tags, testing::IsSupersetOf({"unknown", "expandable"}));
}

TEST_F(TablesTest, ShowCausesOfFailedPointsAndPointsThatWereAdded) {
  const std::vector<SpacePlan> plans = plansAtTheEnd();
  ASSERT_TRUE(plans[0].complete() && plans[1].complete());
  ASSERT_GT(plans[0].size(), 33) << "the probes";
  open().showAll(plans);
  const std::vector<PointRow> rows = shown();
  EXPECT_EQ(rows, rowsFor(plans));
  EXPECT_TRUE(std::ranges::any_of(
      rows, [](const PointRow& row) { return row.tag == "failed" && row.cause != "none"; }));
  EXPECT_TRUE(std::ranges::none_of(rows, [](const PointRow& row) { return row.tag == "unknown"; }));
}

TEST_F(TablesTest, ShowNoPointsOrSpacesThatThereAreNotAfterDamage) {
  const std::vector<SpacePlan> plans = plansAfter(25);
  open().showAll(plans);
  alter("UPDATE configurations SET point = -4294967295 WHERE space = 0 AND point = 2");
  alter("UPDATE configurations SET space = 7 WHERE space = 1 AND point = 3");
  alter("UPDATE configurations SET space = -4294967296 WHERE space = 1 AND point = 4");
  ASSERT_NE(shown(), rowsFor(plans));
  open().showAll(plans);
  EXPECT_EQ(shown(), rowsFor(plans));
}

TEST_F(TablesTest, ShowOfWhatChangedThatAlone) {
  const std::vector<SpacePlan> before = plansAtFirst(), now = plansAfter(20);
  Tables tables = open();
  tables.showAll(before);
  tables.show(now, std::vector<Changed>{{1, 3}, {0, 0}});
  std::vector<PointRow> expected = rowsFor(before);
  for (PointRow& row : expected)
    if ((row.space == 1 && row.number == 3) || (row.space == 0 && row.number == 0))
      row = rowOf(row.space, row.number, now[row.space]);
  EXPECT_EQ(shown(), expected);
  EXPECT_NE(shown(), rowsFor(before));
}

TEST_F(TablesTest, PartsOfAnySizeComeToTheWhole) {
  const std::vector<SpacePlan> plans = plansAtTheEnd();
  const std::int32_t all = plans[0].size() + plans[1].size();
  for (const std::int32_t most :
       {1, 2, 7, plans[0].size() - 1, plans[0].size(), plans[0].size() + 1, all - 1, all, all + 1,
        std::numeric_limits<std::int32_t>::max()}) {
    Tables tables = open();
    tables.showAll(plansAtFirst());
    int parts = 1;
    for (Changed next = {0, 0}; !tables.showSome(plans, next, most); ++parts)
      ASSERT_LT(parts, all) << "the last part is told";
    EXPECT_EQ(parts, (all - 1) / most + 1) << "of " << most;
    EXPECT_EQ(shown(), rowsFor(plans)) << "of " << most;
  }
}

/// Whoever has something else to do meanwhile waits for no more than he asked for.
TEST_F(TablesTest, APartIsOfTheNextPointsAndOfNoMore) {
  const std::vector<SpacePlan> before = plansAtFirst(), now = plansAtTheEnd();
  for (const std::int32_t most : {1, 10, now[0].size(), 50}) {
    Tables tables = open();
    tables.showAll(before);
    std::int32_t done = 0;
    for (Changed next = {0, 0}; !tables.showSome(now, next, most);) {
      done += most;
      const std::int32_t first = now[0].size();
      EXPECT_EQ(next.space, done < first ? 0u : 1u) << "of " << most;
      EXPECT_EQ(next.point, done < first ? done : done - first);
      ASSERT_EQ(shown(), midway(before, now, done)) << done << " in parts of " << most;
    }
  }
}

TEST_F(TablesTest, CutBetweenTwoPartsTheyAreOfSomeMomentBeforeAndCanBeBroughtUpToDate) {
  const std::vector<SpacePlan> before = plansAfter(10), now = plansAtTheEnd();
  for (int parts = 0; parts < 8; ++parts) {
    {
      Tables tables = open();
      tables.showAll(before);
      Changed next = {0, 0};
      for (int part = 0; part < parts; ++part) tables.showSome(now, next, 10);
    }
    StoredTables(held.path()).verify();
    EXPECT_EQ(shown(), midway(before, now, 10 * parts)) << parts;
    Tables tables = open();
    for (Changed next = {0, 0}; !tables.showSome(now, next, 10);) {
    }
    EXPECT_EQ(shown(), rowsFor(now)) << parts;
  }
}

/// As a disk that takes no more would have it.
TEST_F(TablesTest, OfAPartThatCannotBeWrittenNothingIsShown) {
  const std::vector<SpacePlan> before = plansAtFirst(), now = plansAtTheEnd();
  {
    Tables tables = open();
    tables.showAll(before);
    alter(
        "CREATE TRIGGER full BEFORE INSERT ON configurations "
        "WHEN NEW.space = 0 AND NEW.point = 17 BEGIN SELECT RAISE(FAIL, 'no room left'); END");
    Changed next = {0, 0};
    EXPECT_FALSE(tables.showSome(now, next, 10));
    test::expectError(ExitCode::failed, [&] { tables.showSome(now, next, 10); },
                      {"state.db", "no room left"});
  }
  EXPECT_EQ(shown(), midway(before, now, 10));
  alter("DROP TRIGGER full");
  open().showAll(now);
  EXPECT_EQ(shown(), rowsFor(now));
}

/// Shows these and those, in turns and in parts, as long as it lives, and writes a byte for each
/// part.
[[noreturn]] void showForEver(Tables tables, const std::vector<SpacePlan>& these,
                              const std::vector<SpacePlan>& those, std::int32_t most,
                              int told) noexcept {
  for (;;)
    for (const auto* plans : {&these, &those})
      for (Changed next = {0, 0}; !tables.showSome(*plans, next, most);)
        if (write(told, "", 1) != 1) _exit(1);
}

TEST_F(TablesTest, OfWhoeverIsKilledWholePartsAreThere) {
  constexpr std::int32_t most = 7;
  const std::vector<SpacePlan> before = plansAtFirst(), now = plansAtTheEnd();
  std::vector<std::vector<PointRow>> moments;
  for (std::int32_t done = 0; done < now[0].size() + now[1].size() + most; done += most) {
    moments.push_back(midway(before, now, done));
    moments.push_back(midway(now, before, done));
  }
  for (int parts = 5; parts <= 25; parts += 5) {
    open().showAll(before);
    int told[2];
    ASSERT_EQ(pipe(told), 0);
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) showForEver(open(), now, before, most, told[1]);
    close(told[1]);
    char one = 0;
    for (int count = 0; count < parts; ++count) ASSERT_EQ(read(told[0], &one, 1), 1);
    // By now it is in the middle of another one.
    kill(child, SIGKILL);
    close(told[0]);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    StoredTables(held.path()).verify();
    EXPECT_THAT(moments, testing::Contains(shown())) << "killed behind " << parts << " parts";
  }
}

TEST_F(TablesTest, RowsOfARunThatKnewMoreGoWithThePartThatEndsTheirSpace) {
  const std::vector<SpacePlan> before = plansAtTheEnd(), now = plansAfter(10);
  ASSERT_LT(now[0].size(), before[0].size());
  for (const std::int32_t most : {10, now[0].size()}) {
    Tables tables = open();
    tables.showAll(before);
    std::int32_t done = 0;
    for (Changed next = {0, 0};;) {
      const bool last = tables.showSome(now, next, most);
      done += most;
      std::map<std::uint32_t, std::int32_t> rows_of;
      for (const PointRow& row : shown()) ++rows_of[row.space];
      EXPECT_EQ(rows_of[0], done < now[0].size() ? before[0].size() : now[0].size()) << done;
      EXPECT_EQ(rows_of[1], last ? now[1].size() : before[1].size()) << done;
      if (last) break;
    }
    EXPECT_EQ(shown(), rowsFor(now));
  }
}

TEST_F(TablesTest, RememberWhoIsKeptOutToTheLastByte) {
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

TEST_F(TablesTest, RememberWhatPeopleSaid) {
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

TEST_F(TablesTest, RememberWhatIsToBeSolvedAgainUntilItIsForgotten) {
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

TEST_F(TablesTest, HaveASecretOfTheirOwnAndMakeAnotherWhereItIsDamaged) {
  const std::string secret = open().secret();
  EXPECT_THAT(secret, SizeIs(32));
  EXPECT_EQ(open().secret(), secret);
  const StateDirectory other(directory / "other");
  EXPECT_NE(Tables(other, problem, encodeProblem(problem)).secret(), secret);
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
