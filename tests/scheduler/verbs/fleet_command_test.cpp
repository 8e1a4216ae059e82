#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/command.hpp"
#include "tests/support/shell_script.hpp"
#include "tests/support/table_worker.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/system/process.hpp"

namespace palpate {
namespace {

/// Regression: under a memory limit, OpenBLAS waited forever while palpate-worker was loaded. Only
/// `palpate` checks the limit before.
TEST(FleetCommand, StartsWorkersByTheProgramThatChecksTheMemoryLimit) {
  const test::TemporaryDirectory directory;
  test::writeEndlessScene(directory.path(), 2, 1);
  const test::Process serve(
      "palpate-scheduler",
      {"serve", "cube.toml", "--listen", "tcp://127.0.0.1:*", "--state", "state", "--insecure"},
      directory.path());
  ASSERT_TRUE(
      test::eventually([&] { return !test::endpointAnnouncedIn(directory / "state").empty(); }));
  test::writeScript(directory / "squeue", "");  // Slurm has no job
  const test::FirstInPath slurm_is{directory.path()};
  for (const std::string kind : {"slurm state", "ssh state --hosts there"}) {
    const test::CommandResult planned = test::runCommand(
        "(cd '" + directory.path().string() + "' && " PALPATE_BIN_DIR "/palpate-scheduler fleet " +
        kind + " --insecure --dry-run)");
    EXPECT_EQ(planned.exit_code, 0) << planned.output;
    EXPECT_THAT(planned.output, testing::ContainsRegex("palpate'? '?work"));
    EXPECT_THAT(planned.output, testing::Not(testing::HasSubstr("palpate-worker")));
  }
}

}  // namespace
}  // namespace palpate
