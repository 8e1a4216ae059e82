#include "common/base/log_lines.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <spdlog/sinks/ostream_sink.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <sstream>

namespace palpate {
namespace {

TEST(LogLines, EveryLineIsOneJsonObjectForAnyMessage) {
  std::ostringstream out;
  spdlog::logger logger("test", std::make_shared<spdlog::sinks::ostream_sink_st>(out));
  logger.set_formatter(jsonLines("palpate-worker", "work"));
  const std::string message = "node \"7\"\\ said\n\x1b[2J and \xff, {}";
  logger.warn("{}", message);
  logger.info("and went");
  std::istringstream lines(out.str());
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  const auto object = nlohmann::json::parse(line);
  EXPECT_EQ(object.at("level"), "warning");
  EXPECT_EQ(object.at("program"), "palpate-worker");
  EXPECT_EQ(object.at("verb"), "work");
  EXPECT_EQ(object.at("pid"), getpid());
  EXPECT_EQ(object.at("message"), "node \"7\"\\ said\n\x1b[2J and \xEF\xBF\xBD, {}");
  EXPECT_THAT(object.at("time").get<std::string>(),
              testing::MatchesRegex("[0-9-]+T[0-9:]+\\.[0-9]+Z"));
  ASSERT_TRUE(std::getline(lines, line));
  EXPECT_EQ(nlohmann::json::parse(line).at("message"), "and went");
}

}  // namespace
}  // namespace palpate
