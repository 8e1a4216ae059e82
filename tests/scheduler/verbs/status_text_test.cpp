#include "scheduler/verbs/status_text.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// A large unfinished build: 12345 of 67890 points.
wire::Status bigBuild() {
  wire::Status status;
  status.set_state("running");
  status.set_may_grow(true);
  status.set_configurations_per_second(128.13);
  status.set_eta_seconds(12000);
  status.set_ready(1234);
  for (int n = 0; n < 16; ++n) status.add_workers();
  wire::SpaceStatus& space = *status.add_spaces();
  space.set_points(67890);
  space.set_expandable(12345);
  space.set_unknown(67890 - 12345);
  return status;
}

TEST(StatusText, WritesDurationsForPeople) {
  EXPECT_EQ(durationText(7.4), "7 s");
  EXPECT_EQ(durationText(720), "12 min");
  EXPECT_EQ(durationText(12000), "3 h 20 min");
}

/// Regression: the line was longer than a row of the terminal, so every update began a new row.
TEST(ProgressLine, FitsTerminalsOfAnyWidth) {
  for (std::size_t columns = 1; columns <= 200; ++columns)
    EXPECT_LT(progressBar(bigBuild(), columns).size(), std::max<std::size_t>(columns, 2))
        << columns;
  EXPECT_THAT(progressBar(bigBuild(), 80), HasSubstr("12345/67890"));
}

TEST(ProgressLine, HasAFullBarWhenEverythingIsKnown) {
  wire::Status status = bigBuild();
  status.mutable_spaces(0)->set_unknown(0);
  status.mutable_spaces(0)->set_expandable(67890);
  EXPECT_THAT(progressBar(status, 120), StartsWith("[############################] 67890/67890"));
  status.mutable_spaces(0)->set_unknown(67890);
  status.mutable_spaces(0)->set_expandable(0);
  EXPECT_THAT(progressBar(status, 120), StartsWith("[                            ] 0/67890"));
}

TEST(ProgressLine, GivesNoTimeForAPausedBuild) {
  wire::Status status = bigBuild();
  EXPECT_THAT(progressLine(status), HasSubstr("left"));
  status.set_paused(true);
  EXPECT_THAT(progressLine(status), Not(HasSubstr("left")));
  EXPECT_THAT(describe(status), HasSubstr("palpate resume"));
}

TEST(Describe, GroupsManyWorkersByMachine) {
  wire::Status status = bigBuild();
  for (int n = 0; n < 16; ++n) {
    wire::WorkerStatus& worker = *status.mutable_workers(n);
    worker.set_host(n < 10 ? "node1" : "node2");
    worker.set_state(n % 2 == 0 ? "busy" : "lost");
    worker.set_results(7);
  }
  status.mutable_spaces(0)->set_name("tip");
  status.mutable_spaces(0)->set_priority(-2);
  EXPECT_THAT(describe(status), testing::AllOf(HasSubstr("node1: 5 busy, 5 lost; 70 "),
                                               HasSubstr("node2: 3 busy, 3 lost; 42 "),
                                               HasSubstr("tip -2"), Not(HasSubstr("worker 0"))));
}

/// Regression: the line showed "0 s left" while points of the stage branches were being solved.
TEST(ProgressLine, GivesNoTimeWhileOnlyBranchesAreSolved) {
  wire::Status status = bigBuild();
  status.mutable_spaces(0)->set_unknown(0);
  status.clear_eta_seconds();
  EXPECT_THAT(progressLine(status), Not(HasSubstr("left")));
  status.mutable_spaces(0)->set_unknown(1);
  EXPECT_THAT(progressLine(status), Not(HasSubstr("left")));
  status.set_eta_seconds(0.2);
  EXPECT_THAT(progressLine(status), HasSubstr("about 1 s left"));
}

TEST(Describe, NamesExclusionsAndDisputes) {
  wire::Status status;
  status.set_disputed(2);
  wire::KeptOut& machine = *status.add_kept_out();
  machine.set_kind("machine");
  machine.set_host("node7");
  machine.set_key(std::string(64, 'a'));
  machine.set_reason("its result of space 0 differs");
  wire::KeptOut& process = *status.add_kept_out();
  process.set_kind("process");
  process.set_worker("0a1b2c3d4e5f");
  process.set_host("node8");
  const std::string text = describe(status);
  for (const char* named :
       {"disputed: 2", "node7", "aaaaaaaaaaaa: its result of space 0 differs", "0a1b2c3d", "node8"})
    EXPECT_THAT(text, HasSubstr(named));
}

}  // namespace
}  // namespace palpate
