#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/command.hpp"
#include "tests/system/small_build.hpp"

/// What somebody who runs a scheduler sees of it from outside: its log and its events.
namespace palpate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

struct OperatingTest : test::SmallBuild {
  test::CommandResult palpate(const std::string& arguments) const {
    return test::runCommand("(cd '" + directory.path().string() +
                            "' && " PALPATE_BIN_DIR "/palpate " + arguments + ")");
  }
  static std::vector<nlohmann::json> objects(const std::string& lines) {
    std::vector<nlohmann::json> all;
    std::istringstream stream(lines);
    for (std::string line; std::getline(stream, line);) {
      all.push_back(nlohmann::json::parse(line, nullptr, false));
      EXPECT_TRUE(all.back().is_object()) << line;
    }
    return all;
  }
  std::vector<nlohmann::json> eventsOf(const std::string& arguments) const {
    return objects(palpate("events " + arguments).output);
  }
  static std::vector<std::string> wordsOf(const std::vector<nlohmann::json>& events) {
    std::vector<std::string> words;
    for (const auto& event : events) words.push_back(event.at("event"));
    return words;
  }
};

TEST_F(OperatingTest, EventsTellHowABuildWent) {
  auto build = startBuild("out.h5", "2");
  expectFinished(*build);
  const auto words = wordsOf(eventsOf("out.h5.state"));
  EXPECT_EQ(words.front(), "started");
  EXPECT_EQ(words.back(), "sealed");
  EXPECT_EQ(std::ranges::count(words, "worker_joined"), 2);
  const auto stages = eventsOf("out.h5.state --event stage");
  ASSERT_THAT(stages, Not(testing::IsEmpty()));
  EXPECT_EQ(stages.back().at("stage"), "complete");
  EXPECT_THAT(eventsOf("out.h5.state --last 2"), SizeIs(2));
  EXPECT_THAT(eventsOf("out.h5.state --event paused"), SizeIs(0));
  EXPECT_EQ(palpate("events out.h5.state --event seald").exit_code, 2);
  EXPECT_EQ(palpate("events cube.toml").exit_code, 2);
  EXPECT_EQ(palpate("check out.h5.state").exit_code, 0) << "they are no damage";
}

TEST_F(OperatingTest, WhatASchedulerRecordedIsToldWhereItEndsWhileItIsAsked) {
  auto serve = start("palpate-scheduler", {"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*",
                                           "--state", "state", "-o", "out.h5"});
  const std::string endpoint = endpointIn("state");
  serve->signal(SIGSTOP);  // the system accepts who asks, and nobody answers
  auto status = start("palpate-scheduler", {"status", "state"});
  const std::string connected = fmt::format(
      ":{:04X} 01", std::stoi(endpoint.substr(endpoint.rfind(':') + 1)));  // of proc(5), tcp
  EXPECT_TRUE(test::eventually([&] {
    return !status->running() ||
           test::contentOf("/proc/net/tcp").find(connected) != std::string::npos;
  }));
  EXPECT_EQ(serve->stop(SIGKILL), 128 + SIGKILL);
  EXPECT_EQ(status->wait(), 0);
  EXPECT_THAT(status->output(), AllOf(HasSubstr("cube"), HasSubstr("stopped")));
}

TEST_F(OperatingTest, ASchedulerThatReadsItsJournalIsNeitherCompleteNorStopped) {
  auto build = startBuild("out.h5", "2");
  expectFinished(*build);
  // As one that was started again and does not listen yet.
  const std::filesystem::path state = directory / "out.h5.state";
  std::filesystem::remove(state / "endpoint");
  std::ofstream(state / "lock") << "4711\n";
  const int lock = open(state.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  EXPECT_THAT(palpate("status out.h5.state").output,
              AllOf(HasSubstr("process 4711"), HasSubstr("starting")));
  for (const char* order : {"stop out.h5.state", "pause out.h5.state"}) {
    const auto told = palpate(order);
    EXPECT_EQ(told.exit_code, 1) << order;
    EXPECT_THAT(told.output, AllOf(HasSubstr("process 4711"), HasSubstr("starting"))) << order;
  }
  auto watch = start("palpate-scheduler", {"status", "out.h5.state", "--watch", "--json"});
  EXPECT_TRUE(test::eventually(
      [&] { return std::ranges::count(watch->output(), '\n') >= 2 || !watch->running(); }));
  EXPECT_TRUE(watch->running());
  close(lock);
  EXPECT_EQ(watch->wait(), 0);
  const auto told = objects(watch->output());
  EXPECT_EQ(told.front().at("state"), "starting");
  EXPECT_EQ(told.back().at("state"), "complete");
}

TEST_F(OperatingTest, EventsAreFollowedWhileTheyHappen) {
  auto serve = start("palpate-scheduler", {"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*",
                                           "--state", "state", "-o", "out.h5"});
  endpointIn("state");
  auto follow = start("palpate-scheduler", {"events", "state", "--follow", "--event", "paused"});
  EXPECT_EQ(palpate("pause state").exit_code, 0);
  EXPECT_TRUE(test::eventually([&] { return follow->output().ends_with("\n"); }));
  EXPECT_THAT(objects(follow->output()), SizeIs(1));
  EXPECT_EQ(follow->stop(SIGINT), 130);
  EXPECT_EQ(serve->stop(SIGTERM), 130);
  EXPECT_THAT(eventsOf("state --event stopped").at(0).at("reason"), "signal");
}

TEST_F(OperatingTest, ALogForProgramsHoldsNothingElse) {
  auto serve =
      start("palpate-scheduler", {"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*", "--state",
                                  "state", "-o", "out.h5", "--log-format", "json"});
  endpointIn("state");
  EXPECT_TRUE(
      test::eventually([&] { return serve->output().find("listening") != std::string::npos; }));
  EXPECT_EQ(serve->stop(SIGTERM), 130);
  for (const auto& line : objects(serve->output())) {
    EXPECT_EQ(line.at("verb"), "serve");
    EXPECT_EQ(line.size(), 6u) << line;
  }
  const auto refused = objects(palpate("serve nowhere.toml --state s --log-format json").output);
  ASSERT_THAT(refused, SizeIs(1));
  EXPECT_THAT(refused[0].at("message").get<std::string>(), HasSubstr("nowhere.toml"));
  EXPECT_EQ(palpate("serve cube.toml --state s --log-format xml").exit_code, 2);
}

}  // namespace
}  // namespace palpate
