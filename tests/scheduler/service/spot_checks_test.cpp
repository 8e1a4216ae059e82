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
  /// By lot, because they are odd, or have failed.
  static int picked(SpotChecks& checks, int results, const SpotChecks::Look& look = {}) {
    int count = 0;
    for (int n = 0; n < results; ++n) count += isPicked(checks, n, look);
    return count;
  }
  static bool isPicked(SpotChecks& checks, int n, const SpotChecks::Look& look = {},
                       int nth = 1'000'000) {
    return checks.pick({0, {n, 0, 0}, {}}, nth, look) != SpotChecks::Picked::no;
  }
};

TEST_F(SpotChecksTest, OneInAHundredIsPickedWhoeverAsks) {
  EXPECT_NEAR(picked(checks, 20000), 200, 60);
  SpotChecks again({}, std::string(32, 's')), others({}, std::string(32, 't'));
  int same = 0, alike = 0;
  for (int n = 0; n < 20000; ++n) {
    const bool it = isPicked(checks, n);
    same += it == isPicked(again, n);
    alike += it && isPicked(others, n);
  }
  EXPECT_EQ(same, 20000) << "a restart picks the same";
  EXPECT_LT(alike, 20) << "without the secret nobody can tell";
}

TEST_F(SpotChecksTest, MoreOfAWorkersFirstOnes) {
  int count = 0;
  for (int build = 0; build < 200; ++build) {
    SpotChecks of_build({}, fmt::format("{:032}", build));
    for (int n = 0; n < 20; ++n) count += isPicked(of_build, n, {}, n + 1);
  }
  EXPECT_NEAR(count, 180, 40) << "1 in 4, 1 in 8, 1 in 12 ...";
}

TEST_F(SpotChecksTest, FailuresArePickedWithinABudget) {
  const int count = picked(checks, 10000, {.failed = true});
  EXPECT_GE(count, 95);
  EXPECT_LE(count, 160) << "1 % by lot, 0.25 % because they failed";
  SpotChecks early({}, std::string(32, 's'));
  EXPECT_EQ(picked(early, 8, {.failed = true}), 8);
}

/// A body where all that is new looks odd, and much fails, is not solved twice.
TEST_F(SpotChecksTest, WhatIsPickedForItsLooksHasABudget) {
  using Picked = SpotChecks::Picked;
  int odd = 0, failed = 0;
  constexpr int results = 20000;
  for (int n = 0; n < results; ++n) {
    const SpotChecks::Look look =
        n % 10 == 0 ? SpotChecks::Look{.failed = true} : SpotChecks::Look{.oddness = 1.0 + n};
    const Picked picked = checks.pick({0, {n, 0, 0}, {}}, 1'000'000, look);
    failed += picked == Picked::as_failed;
    if (picked == Picked::as_odd) odd += 1 + checks.pickStart({1, {n, 0, 0}, {}});
  }
  EXPECT_NEAR(odd, 0.0065 * results, 2);
  EXPECT_NEAR(failed, 0.0025 * results, 2) << "neither takes from the other";
}

/// A body whose honest results are odd, too, has odder ones when somebody lies.
TEST_F(SpotChecksTest, TheOddestArePickedWhateverIsUsual) {
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

TEST_F(SpotChecksTest, BeforeMuchIsKnownWhatIsOddOnALiverIsPicked) {
  EXPECT_TRUE(isPicked(checks, 1, {.oddness = 3.1}));
  EXPECT_TRUE(isPicked(checks, 2, {.oddness = std::numeric_limits<double>::infinity()}));
}

TEST_F(SpotChecksTest, TwoThatAgreeAreRight) {
  checks.open(key, {who("a"), "x"}, {});
  const auto verdict = checks.hear(key, {who("b"), "x"});
  ASSERT_TRUE(verdict);
  EXPECT_TRUE(verdict->wrong.empty());
  EXPECT_EQ(verdict->right.size(), 2u);
  EXPECT_FALSE(checks.isOpen(key));
  EXPECT_FALSE(checks.pickStart(key)) << "once is enough";
}

TEST_F(SpotChecksTest, AThirdDecidesWhichOfTwoIsWrong) {
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

TEST_F(SpotChecksTest, AsLongAsNoneAgreeOthersAreAsked) {
  checks.open(key, {who("a"), "x"}, {});
  EXPECT_FALSE(checks.hear(key, {who("b"), "y"}));
  EXPECT_FALSE(checks.hear(key, {who("c"), "z"}));
  const auto verdict = checks.hear(key, {who("d"), "y"});
  ASSERT_TRUE(verdict);
  EXPECT_EQ(wrongOnes(*verdict), (std::vector<std::string>{"a", "c"}));
}

TEST_F(SpotChecksTest, NobodyIsAskedTwice) {
  checks.open(key, {who("a", "one"), "x"}, {});
  EXPECT_EQ(checks.apart(key, who("a", "elsewhere")), Apart::same_process);
  EXPECT_EQ(checks.apart(key, who("b", "one")), Apart::same_machine);
  EXPECT_EQ(checks.apart(key, who("b", "two")), Apart::same_key);
  EXPECT_EQ(checks.apart(key, who("b", "one", "key")), Apart::other_key)
      << "another's machine of that name";
  EXPECT_FALSE(checks.contradicts(key, {who("a"), "x"}));
  EXPECT_TRUE(checks.contradicts(key, {who("a"), "y"}));
  EXPECT_FALSE(checks.contradicts(key, {who("b"), "y"}));
}

TEST_F(SpotChecksTest, OthersAreAskedWhoAreAsFarAwayAsThereAre) {
  checks.open(key, {who("a", "one", "k"), "x"}, {});
  EXPECT_EQ(checks.wanted(key, {{"k"}, {{"k", "one"}}}), Apart::same_machine);
  EXPECT_EQ(checks.wanted(key, {{"k"}, {{"k", "one"}, {"k", "two"}}}), Apart::same_key);
  EXPECT_EQ(checks.wanted(key, {{"k"}, {{"k", "two"}}}), Apart::same_key) << "the first is gone";
  EXPECT_EQ(checks.wanted(key, {{"k", "l"}, {{"k", "two"}}}), Apart::other_key)
      << "whose machines were here a while ago";
  EXPECT_EQ(checks.wanted(key, {{"l"}, {{"l", "one"}}}), Apart::other_key);
}

/// Who has a key can be as many workers, on as many machines, as he likes.
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

Kind kindOf(const SpotChecks::Verdict& verdict, const std::vector<KeptOut>& before = {}) {
  return keptOutBy(verdict, before, "why").at(0).kind;
}

TEST(KeptOutBy, TheMachineUnlessOthersOnItWereRight) {
  EXPECT_EQ(kindOf({{who("b", "two"), who("c", "three")}, {who("a", "one")}}), Kind::machine);
  EXPECT_EQ(kindOf({{who("b", "one"), who("c", "three")}, {who("a", "one")}}), Kind::process);
}

TEST(KeptOutBy, TheMachineOnceTwoOfItsProcessesWereFound) {
  const SpotChecks::Verdict verdict = {{who("b", "one"), who("c", "three")}, {who("a", "one")}};
  EXPECT_EQ(kindOf(verdict, {{Kind::process, who("x", "one"), ""}}), Kind::process);
  EXPECT_EQ(
      kindOf(verdict, {{Kind::process, who("x", "one"), ""}, {Kind::process, who("y", "one"), ""}}),
      Kind::machine);
}

TEST(KeptOutBy, AKeyOnceTwoOfItsMachinesWereFound) {
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
      << "it has none";
}

TEST(KeptOut, CoversWhatItSays) {
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
