#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/system/small_build.hpp"

/// What an operator sees of a scheduler: its log and its events.
namespace palpate {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

struct OperatingTest : test::SmallBuild {
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
  told("events out.h5.state --event seald", 2);
  told("events cube.toml", 2);
  told("check out.h5.state");  // not reported as damage
}

TEST_F(OperatingTest, StatusShowsTheRecordsOfASchedulerThatEndsMeanwhile) {
  auto scheduler = serve("state", "out.h5");
  const std::string endpoint = endpointIn("state");
  scheduler->signal(SIGSTOP);  // the system accepts connections, but nobody answers
  auto status = start("palpate-scheduler", {"status", "state"});
  const std::string connected = fmt::format(
      ":{:04X} 01",
      std::stoi(endpoint.substr(endpoint.rfind(':') + 1)));  // format of /proc/net/tcp, proc(5)
  EXPECT_TRUE(test::eventually([&] {
    return !status->running() ||
           test::contentOf("/proc/net/tcp").find(connected) != std::string::npos;
  }));
  EXPECT_EQ(scheduler->stop(SIGKILL), 128 + SIGKILL);
  EXPECT_EQ(status->wait(), 0);
  EXPECT_THAT(status->output(), AllOf(HasSubstr("cube"), HasSubstr("stopped")));
}

TEST_F(OperatingTest, ASchedulerThatReadsItsJournalIsNeitherCompleteNorStopped) {
  auto build = startBuild("out.h5", "2");
  expectFinished(*build);
  // A restarted scheduler that does not listen yet.
  const std::filesystem::path state = directory / "out.h5.state";
  std::filesystem::remove(state / "endpoint");
  std::ofstream(state / "lock") << "4711\n";
  const int lock = open(state.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(flock(lock, LOCK_EX), 0);
  const auto names_it = AllOf(HasSubstr("process 4711"), HasSubstr("starting"));
  EXPECT_THAT(told("status out.h5.state"), names_it);
  for (const char* order : {"stop out.h5.state", "pause out.h5.state"})
    EXPECT_THAT(told(order, 1), names_it);
  auto watch = start("palpate-scheduler", {"status", "out.h5.state", "--watch", "--json"});
  EXPECT_TRUE(test::eventually(
      [&] { return std::ranges::count(watch->output(), '\n') >= 2 || !watch->running(); }));
  EXPECT_TRUE(watch->running());
  close(lock);
  EXPECT_EQ(watch->wait(), 0);
  const auto seen = objects(watch->output());
  EXPECT_EQ(seen.front().at("state"), "starting");
  EXPECT_EQ(seen.back().at("state"), "complete");
}

TEST_F(OperatingTest, EventsAreFollowedWhileTheyHappen) {
  auto scheduler = serve("state", "out.h5");
  endpointIn("state");
  auto follow = start("palpate-scheduler", {"events", "state", "--follow", "--event", "paused"});
  told("pause state");
  EXPECT_TRUE(test::eventually([&] { return follow->output().ends_with("\n"); }));
  EXPECT_THAT(objects(follow->output()), SizeIs(1));
  EXPECT_EQ(follow->stop(SIGINT), 130);
  EXPECT_EQ(scheduler->stop(SIGTERM), 130);
  EXPECT_THAT(eventsOf("state --event stopped").at(0).at("reason"), "signal");
}

TEST_F(OperatingTest, AJsonLogHoldsOnlyJson) {
  auto scheduler = serve("state", "out.h5", {"--log-format", "json"});
  endpointIn("state");
  EXPECT_TRUE(test::says(*scheduler, "listening"));
  EXPECT_EQ(scheduler->stop(SIGTERM), 130);
  for (const auto& line : objects(scheduler->output())) {
    EXPECT_EQ(line.at("verb"), "serve");
    EXPECT_EQ(line.size(), 6u) << line;
  }
  const auto refused = objects(palpate("serve nowhere.toml --state s --log-format json").output);
  ASSERT_THAT(refused, SizeIs(1));
  EXPECT_THAT(refused[0].at("message").get<std::string>(), HasSubstr("nowhere.toml"));
  told("serve cube.toml --state s --log-format xml", 2);
}

}  // namespace
}  // namespace palpate
