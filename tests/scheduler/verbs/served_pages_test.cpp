#include "scheduler/verbs/served_pages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <future>
#include <sstream>

#include "tests/scheduler/build_world.hpp"
#include "tests/support/http_get.hpp"

namespace palpate {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// The answer to `path` of a scheduler for `problem`.
std::string answerOf(const Problem& problem, const std::string& path) {
  test::BuildWorld world(test::BuildWorld::withoutChecks(), problem);
  std::ostringstream log;
  const auto before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "pages", std::make_shared<spdlog::sinks::ostream_sink_mt>(log)));
  ServedPages pages({.metrics = "", .dashboard = "0"}, world.directory / "state");
  spdlog::set_default_logger(before);
  const std::string said = log.str();
  const int port = std::stoi(said.substr(said.find("127.0.0.1:") + 10));
  auto answer = std::async(std::launch::async, [&] { return test::httpGet(port, path); });
  while (answer.wait_for(std::chrono::milliseconds(1)) != std::future_status::ready)
    pages.offer(world.coordinator());
  return answer.get();
}

/// Regression: explaining a point of ten million took 11 GB in the scheduler's process.
TEST(ServedPages, APointOfALargeBuildIsNotReadInTheSchedulersProcess) {
  const std::string path = "/explain.json?active=tip&i=1&j=0&k=-2";
  EXPECT_THAT(
      answerOf(test::cubeProblemOf(2, 0.3, 1300), path),
      AllOf(HasSubstr(" 413 "), HasSubstr("palpate explain"), HasSubstr("--active tip 1 0 -2")));
  EXPECT_THAT(answerOf(test::cubeProblemOf(2, 0.02, 1300), "/explain.json?active=tip&i=1&j=0&k=0"),
              AllOf(HasSubstr(" 200 "), HasSubstr("\"active\":\"tip\"")));
}

}  // namespace
}  // namespace palpate
