#include "scheduler/service/spot_checks.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

wire::Provenance who(const std::string& worker, const std::string& host = "here",
                     const std::string& key = "") {
  wire::Provenance provenance;
  provenance.set_worker(worker);
  provenance.set_host(host);
  provenance.set_key(key);
  return provenance;
}

struct SpotChecksTest : testing::Test {
  const ResultKey key = {0, {1, 0, 0}, {}};
  SpotChecks checks{{}, std::string(32, 's')};

  std::vector<std::string> wrongOnes(const SpotChecks::Verdict& verdict) {
    std::vector<std::string> ids;
    for (const wire::Provenance& liar : verdict.wrong) ids.push_back(liar.worker());
    return ids;
  }
  static int picked(SpotChecks& checks, int results, const SpotChecks::Look& look = {}) {
    int count = 0;
    for (int n = 0; n < results; ++n) count += isPicked(checks, n, look);
    return count;
  }
  static bool isPicked(SpotChecks& checks, int n, const SpotChecks::Look& look = {}) {
    return checks.pick({0, {n, 0, 0}, {}}, look);
  }
};

TEST_F(SpotChecksTest, OneInAHundredIsPickedForAnyWorker) {
  EXPECT_NEAR(picked(checks, 20000), 200, 60);
  SpotChecks again({}, std::string(32, 's')), others({}, std::string(32, 't'));
  int same = 0, alike = 0;
  for (int n = 0; n < 20000; ++n) {
    const bool it = isPicked(checks, n);
    same += it == isPicked(again, n);
    alike += it && isPicked(others, n);
  }
  EXPECT_EQ(same, 20000) << "a restart picks the same results";
  EXPECT_LT(alike, 20) << "nobody can predict it without the secret";
}

TEST_F(SpotChecksTest, AllArePickedIfAllAreRequested) {
  SpotChecks of_all({.share = 1}, std::string(32, 's'));
  EXPECT_EQ(picked(of_all, 500), 500);
  EXPECT_EQ(picked(of_all, 500, {.failed = true}), 500);
  SpotChecks of_none({.share = 0}, std::string(32, 's'));
  EXPECT_EQ(picked(of_none, 500, {.failed = true}), 0);
}

/// For a body in which all new results look odd, and many fail, not everything is solved twice.
TEST_F(SpotChecksTest, OneInAHundredIsPickedForAnyResults) {
  int odd = 0, failed = 0, usual = 0;
  constexpr int results = 20000;
  for (int n = 0; n < results; ++n) {
    if (n % 10 == 0) failed += isPicked(checks, n, {.failed = true});
    if (n % 10 == 1) odd += isPicked(checks, n, {.oddness = 1.0 + n});
    if (n % 10 > 1) usual += isPicked(checks, n);
  }
  EXPECT_NEAR(failed, 50, 20) << "neither kind reduces the other";
  EXPECT_NEAR(odd, 50, 20);
  EXPECT_NEAR(usual, 100, 40) << "ordinary results are picked too";
}

TEST_F(SpotChecksTest, TheFirstSuspectsOfFewResultsArePicked) {
  EXPECT_EQ(picked(checks, 8, {.failed = true}), 8);
  EXPECT_LT(picked(checks, 92, {.failed = true}), 10);
}

/// Even if honest results of a body are odd, lies are odder.
TEST_F(SpotChecksTest, TheOddestResultsArePickedWhateverIsUsual) {
  for (const double usual : {1e-6, 1.0, 50.0}) {
    SpotChecks of_body({}, std::string(32, 's'));
    std::mt19937 random(7);
    std::exponential_distribution<double> oddness(1 / usual);
    int honest = 0;
    constexpr int results = 20000;
    for (int n = 0; n < results; ++n)
      honest += isPicked(of_body, n, {.oddness = std::min(oddness(random), 7 * usual)});
    EXPECT_LE(honest, 0.02 * results + 100) << usual;
    for (int n = 0; n < 5; ++n)
      EXPECT_TRUE(isPicked(of_body, results + n, {.oddness = 8 * usual})) << usual;
  }
}

TEST_F(SpotChecksTest, EarlyResultsAreJudgedByWhatIsOddOnALiver) {
  EXPECT_TRUE(isPicked(checks, 1, {.oddness = 3.1}));
  EXPECT_TRUE(isPicked(checks, 2, {.oddness = std::numeric_limits<double>::infinity()}));
}

TEST_F(SpotChecksTest, TwoResultsThatAgreeAreRight) {
  checks.open(key, {who("a"), "x"}, {});
  const auto verdict = checks.hear(key, {who("b"), "x"});
  ASSERT_TRUE(verdict);
  EXPECT_TRUE(verdict->wrong.empty());
  EXPECT_EQ(verdict->right.size(), 2u);
  EXPECT_FALSE(checks.isOpen(key));
}

TEST_F(SpotChecksTest, AThirdResultDecidesWhichOfTwoIsWrong) {
  checks.open(key, {who("a"), "x"}, {});
  EXPECT_FALSE(checks.hear(key, {who("b"), "y"}));
  EXPECT_TRUE(checks.isDisputed(key));
  EXPECT_EQ(checks.disputedCount(), 1u);
  const auto verdict = checks.hear(key, {who("c"), "y"});
  ASSERT_TRUE(verdict);
  EXPECT_EQ(wrongOnes(*verdict), std::vector<std::string>{"a"});
  checks.open(key, {who("a"), "x"}, {});
  checks.hear(key, {who("b"), "y"});
  EXPECT_EQ(wrongOnes(*checks.hear(key, {who("c"), "x"})), std::vector<std::string>{"b"});
}

TEST_F(SpotChecksTest, MoreWorkersAreAskedUntilTwoAgree) {
  checks.open(key, {who("a"), "x"}, {});
  EXPECT_FALSE(checks.hear(key, {who("b"), "y"}));
  EXPECT_FALSE(checks.hear(key, {who("c"), "z"}));
  const auto verdict = checks.hear(key, {who("d"), "y"});
  ASSERT_TRUE(verdict);
  EXPECT_EQ(wrongOnes(*verdict), (std::vector<std::string>{"a", "c"}));
}

TEST_F(SpotChecksTest, NoWorkerIsAskedTwice) {
  checks.open(key, {who("a", "one"), "x"}, {});
  EXPECT_EQ(checks.apart(key, who("a", "elsewhere")), Apart::same_process);
  EXPECT_EQ(checks.apart(key, who("b", "one")), Apart::same_machine);
  EXPECT_EQ(checks.apart(key, who("b", "two")), Apart::other_machine);
  EXPECT_EQ(checks.apart(key, who("b", "one", "key")), Apart::other_key)
      << "a machine of the same name with another key";
  EXPECT_FALSE(checks.contradicts(key, {who("a"), "x"}));
  EXPECT_TRUE(checks.contradicts(key, {who("a"), "y"}));
  EXPECT_FALSE(checks.contradicts(key, {who("b"), "y"}));
}

TEST_F(SpotChecksTest, AnotherMachineAndKeyAreAskedIfAvailable) {
  const auto wanted = [&](const Crowd& at_work) { return checks.wanted(key, at_work, at_work); };
  checks.open(key, {who("a", "one", "k"), "x"}, {});
  const Crowd alone = {{"k"}, {{"k", "one"}}}, two = {{"k"}, {{"k", "one"}, {"k", "two"}}};
  EXPECT_EQ(wanted(alone), Apart::other_machine);
  EXPECT_EQ(wanted(two), Apart::other_machine);
  EXPECT_EQ(wanted({{"k", "l"}, {{"k", "one"}, {"l", "one"}}}), Apart::other_key);
  EXPECT_EQ(wanted({{"l"}, {{"l", "one"}}}), Apart::other_key) << "the first is gone";
}

/// Without this rule, a machine with occasional memory faults would end every build without a
/// dataset.
TEST_F(SpotChecksTest, AnotherProcessSettlesADisputeIfNoOtherMachineMayJoin) {
  const Crowd two = {{"k"}, {{"k", "one"}, {"k", "two"}}};
  const Crowd three = {{"k"}, {{"k", "one"}, {"k", "two"}, {"k", "three"}}};
  checks.open(key, {who("a", "one", "k"), "x"}, {});
  EXPECT_FALSE(checks.hear(key, {who("b", "two", "k"), "y"}));
  EXPECT_EQ(checks.wanted(key, two, three), Apart::other_machine);
  EXPECT_EQ(checks.wanted(key, two, two), Apart::same_machine);
}

/// The owner of a key can run any number of workers on any number of machines.
TEST_F(SpotChecksTest, OneKeyDoesNotOutvoteAnotherUnlessItIsTrusted) {
  const auto vote = [&](SpotChecks& asked) {
    asked.open(key, {who("a", "one", "k"), "x"}, {});
    EXPECT_FALSE(asked.hear(key, {who("m", "m1", "liar"), "y"}));
    EXPECT_FALSE(asked.hear(key, {who("n", "m2", "liar"), "y"}));
    EXPECT_TRUE(asked.isDisputed(key));
  };
  vote(checks);
  EXPECT_EQ(wrongOnes(*checks.hear(key, {who("b", "two", "third"), "x"})),
            (std::vector<std::string>{"m", "n"}));

  SpotChecks again({}, std::string(32, 's'));
  vote(again);
  EXPECT_FALSE(again.hear(key, {who("b", "two", "k"), "x"})) << "two against two";

  const PublicKey own = KeyPair::make().open();
  const std::string bytes(own.bytes().begin(), own.bytes().end());
  SpotChecks at_home({.trusted_key = own}, std::string(32, 's'));
  vote(at_home);
  const auto verdict = at_home.hear(key, {who("b", "two", bytes), "x"});
  EXPECT_EQ(wrongOnes(*verdict), (std::vector<std::string>{"m", "n"}));
}

using Kind = KeptOut::Kind;

Kind kindOf(const SpotChecks::Verdict& verdict, const std::vector<KeptOut>& before = {},
            const std::optional<PublicKey>& trusted = {}) {
  return keptOutBy(verdict, before, "why", trusted).at(0).kind;
}

TEST(KeptOutBy, ExcludesTheMachineUnlessOthersOnItWereRight) {
  EXPECT_EQ(kindOf({{who("b", "two"), who("c", "three")}, {who("a", "one")}}), Kind::machine);
  EXPECT_EQ(kindOf({{who("b", "one"), who("c", "three")}, {who("a", "one")}}), Kind::process);
}

TEST(KeptOutBy, ExcludesTheMachineAfterTwoLyingProcesses) {
  const SpotChecks::Verdict verdict = {{who("b", "one"), who("c", "three")}, {who("a", "one")}};
  EXPECT_EQ(kindOf(verdict, {{Kind::process, who("x", "one"), ""}}), Kind::process);
  EXPECT_EQ(
      kindOf(verdict, {{Kind::process, who("x", "one"), ""}, {Kind::process, who("y", "one"), ""}}),
      Kind::machine);
}

TEST(KeptOutBy, ExcludesAKeyAfterTwoLyingMachines) {
  const std::vector<KeptOut> before = {{Kind::machine, who("x", "eight", "k"), ""},
                                       {Kind::machine, who("y", "nine", "k"), ""}};
  const wire::Provenance liar = who("a", "one", "k");
  EXPECT_EQ(kindOf({{who("b", "two", "l"), who("c", "three", "m")}, {liar}}, before), Kind::key);
  EXPECT_EQ(kindOf({{who("b", "two", "k"), who("c", "three", "m")}, {liar}}, before), Kind::machine)
      << "honest ones share it";
  const std::vector<KeptOut> processes = {{Kind::process, who("x", "eight", "k"), ""},
                                          {Kind::process, who("y", "nine", "k"), ""}};
  EXPECT_EQ(kindOf({{who("b", "two", "l"), who("c", "three", "m")}, {liar}}, processes),
            Kind::machine)
      << "one of many on their machines";
  EXPECT_EQ(kindOf({{who("b", "two"), who("c", "three")}, {who("a", "one")}}, before),
            Kind::machine)
      << "it has no key";
}

/// Without this rule, a liar with an honest helper under one key could return under other host
/// names forever.
TEST(KeptOutBy, ExcludesAnUntrustedKeyTheFifthTime) {
  const PublicKey key = KeyPair::make().open();
  const std::string bytes(key.bytes().begin(), key.bytes().end());
  std::vector<KeptOut> before;
  for (const std::string host : {"one", "two", "three", "four", "five"}) {
    const SpotChecks::Verdict verdict = {{who("helper", "home", bytes), who("b", "b", "other")},
                                         {who("liar at " + host, host, bytes)}};
    EXPECT_EQ(kindOf(verdict, before), host == "five" ? Kind::key : Kind::machine) << host;
    EXPECT_EQ(kindOf(verdict, before, key), Kind::machine) << "the scheduler's own";
    before.push_back({Kind::machine, verdict.wrong[0], ""});
  }
}

TEST(KeptOut, CoversItsProcessMachineOrKey) {
  const wire::Provenance liar = who("a", "one", "k");
  const KeptOut process{Kind::process, liar, ""}, machine{Kind::machine, liar, ""},
      key{Kind::key, liar, ""};
  EXPECT_TRUE(process.covers(who("a", "elsewhere")));
  EXPECT_FALSE(process.covers(who("b", "one", "k")));
  EXPECT_TRUE(machine.covers(who("b", "one", "k")));
  EXPECT_FALSE(machine.covers(who("b", "one", "l")));
  EXPECT_TRUE(key.covers(who("b", "two", "k")));
  EXPECT_FALSE(key.covers(who("b", "two", "l")));
}

}  // namespace
}  // namespace palpate
