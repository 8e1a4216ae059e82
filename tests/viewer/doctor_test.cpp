#include "viewer/doctor.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/command.hpp"
#include "viewer/haptics/real_time.hpp"

namespace palpate {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

Finding findingOf(const std::string& topic) {
  const std::vector<Finding> findings = examineMachine();
  const auto found = std::find_if(findings.begin(), findings.end(),
                                  [&](const Finding& finding) { return finding.topic == topic; });
  EXPECT_NE(found, findings.end()) << topic;
  return found == findings.end() ? Finding{} : *found;
}

TEST(Doctor, MeasuresHowLateTheTimerWakes) {
  EXPECT_THAT(findingOf("timer").found, HasSubstr("us in 1000 sleeps"));
}

/// Regression: the doctor tried priority 1 and advised 80, but the loop's watchdog requests 81.
TEST(Doctor, TriesAndAdvisesTheHighestPriorityThatTheLoopAsksFor) {
  const Finding finding = findingOf("real-time priority");
  EXPECT_THAT(finding.found, HasSubstr("SCHED_FIFO 81 is "));
  if (refusalOfPriority(watchdog_priority) == 0)
    EXPECT_THAT(finding.found, HasSubstr("granted"));
  else
    EXPECT_THAT(finding.advice, HasSubstr("@realtime - rtprio 81\""));
}

TEST(Doctor, SaysWhatToDoWithoutADisplay) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const Finding none = findingOf("display");
  EXPECT_EQ(none.verdict, Finding::Verdict::note);
  EXPECT_THAT(none.advice, HasSubstr("--headless"));
  setenv("DISPLAY", ":7", 1);
  EXPECT_EQ(findingOf("display").found, "DISPLAY=:7");
  unsetenv("DISPLAY");
}

TEST(Doctor, AsksTheWorkerWhichKernelsSolve) {
  const auto result = test::runCommand(PALPATE_BIN_DIR "/palpate-viewer doctor");
  EXPECT_THAT(result.output, ContainsRegex("solver kernels +[a-z0-9]+/[A-Za-z0-9]+\n"));
  const auto slow =
      test::runCommand("OPENBLAS_CORETYPE=Prescott " PALPATE_BIN_DIR "/palpate-viewer doctor");
  EXPECT_THAT(slow.output, HasSubstr("/Prescott\n"));
  if (__builtin_cpu_supports("avx2")) {
    EXPECT_THAT(slow.output, HasSubstr("unset it"));
  }
}

TEST(Doctor, PrintsOneJsonObjectPerLine) {
  std::istringstream lines(describeJson({{Finding::Verdict::note, "display", "none", "make one"}}));
  std::string line;
  ASSERT_TRUE(std::getline(lines, line));
  const auto finding = nlohmann::json::parse(line);
  EXPECT_EQ(finding.at("verdict"), "note");
  EXPECT_EQ(finding.at("advice"), "make one");
  EXPECT_FALSE(std::getline(lines, line));
}

}  // namespace
}  // namespace palpate
