#include "scheduler/service/status.hpp"

#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

TEST(Status, SurvivesJson) {
  wire::Status status;
  status.set_scene("a \"quoted\"\nname");
  status.set_eta_seconds(12.5);
  (*status.mutable_failed_attempts())["step_budget"] = 3;
  const wire::Status back = statusFromJson(toJson(status));
  EXPECT_EQ(back.scene(), status.scene());
  EXPECT_EQ(back.eta_seconds(), 12.5);
  EXPECT_EQ(back.failed_attempts().at("step_budget"), 3);
  test::expectError(ExitCode::failed, [] { statusFromJson("<html>"); }, {"not a status"});
}

}  // namespace
}  // namespace palpate
