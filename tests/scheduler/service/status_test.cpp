#include "scheduler/service/status.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"

namespace palpate {
namespace {

TEST(Status, SurvivesJson) {
  wire::Status status;
  status.set_scene("a \"quoted\"\nname");
  status.set_eta_seconds(12.5);
  (*status.mutable_failed_attempts())["step_budget"] = 3;
  const wire::Status back = statusFromJson(toJson(status), "a");
  EXPECT_EQ(back.scene(), status.scene());
  EXPECT_EQ(back.eta_seconds(), 12.5);
  EXPECT_EQ(back.failed_attempts().at("step_budget"), 3);
  test::expectError(ExitCode::failed, [] { statusFromJson("<html>", "tcp://n7:1"); },
                    {"tcp://n7:1", "not a status"});
}

TEST(Status, IsRefusedWithImpossibleNumbersOfPoints) {
  const auto refuse = [](const std::string& spaces) {
    test::expectError(ExitCode::failed,
                      [&] { statusFromJson(R"({"spaces":[)" + spaces + "]}", "a"); },
                      {"not a status", "numbers of points"});
  };
  refuse(R"({"points":2147483647,"unknown":-1})");
  refuse(R"({"points":-2})");
  refuse(R"({"points":3,"failed":4})");
  refuse(R"({"points":2000000000},{"points":2000000000})");
  EXPECT_EQ(statusFromJson(R"({"spaces":[{"points":3,"failed":3}]})", "a").spaces(0).failed(), 3);
}

TEST(Status, OmitsUnknownValues) {
  const wire::Status status =
      statusFromJson(R"({"news":[1],"spaces":[{"points":3,"":{"a":1}}]})", "a");
  EXPECT_EQ(status.SerializeAsString(), statusFromJson(toJson(status), "a").SerializeAsString());
}

TEST(Status, HasOneRowForAllProbePlacesOfAnArea) {
  const Problem problem = test::FingerBody(5).problem;
  std::vector<SpacePlan> plans;
  for (std::uint32_t space = 0; space < problem.active.size(); ++space)
    plans.emplace_back(problem, space);
  const wire::Status status = statusOf(problem, plans);
  ASSERT_EQ(status.spaces_size(), static_cast<int>(problem.active.size()) - 4);
  const wire::SpaceStatus& row = *status.spaces().rbegin();
  EXPECT_EQ(row.name(), "probes of top");
  EXPECT_EQ(row.points(), 5);
  EXPECT_EQ(row.unknown(), 5);
  EXPECT_EQ(row.stage(), "lattice");
}

}  // namespace
}  // namespace palpate
