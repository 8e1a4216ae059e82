#include "common/base/foreign_program.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <thread>

#include "tests/support/expect_error.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using test::expectError;

TEST(ForeignProgram, GetsItsArgumentsUnchangedAndReturnsItsOutput) {
  const Ran ran = runToItsEnd({.words = {"sh", "-c", "cat; echo \"$1\" >&2; exit 7", "sh", "a  $b"},
                               .package = "dash",
                               .input = std::string(300000, 'x')});
  EXPECT_EQ(ran.exit_code, 7);
  EXPECT_EQ(ran.out, std::string(300000, 'x'));
  EXPECT_EQ(ran.err, "a  $b\n");
}

TEST(ForeignProgram, AMissingProgramIsNamedWithItsPackage) {
  expectBadInput([] { runToItsEnd({.words = {"no-such-program"}, .package = "no-package"}); },
                 {"no-such-program is not installed here", "(Debian: no-package)"});
  EXPECT_TRUE(isInstalled("sh"));
  EXPECT_TRUE(isInstalled("/bin/sh"));
  EXPECT_FALSE(isInstalled("no-such-program"));
  EXPECT_FALSE(isInstalled("/etc/passwd"));
}

TEST(ForeignProgram, WithoutExecutePermissionIsNotReportedAsMissing) {
  expectError(ExitCode::failed, [] { runToItsEnd({.words = {"/etc/passwd"}, .package = "none"}); },
              {"/etc/passwd cannot be run", "denied"});
}

TEST(ForeignProgram, IsKilledAfterItsTimeoutAndItsOutputReported) {
  expectError(ExitCode::failed,
              [] {
                runToItsEnd({.words = {"sh", "-c", "echo thinking >&2; exec sleep 60"},
                             .package = "dash",
                             .patience = std::chrono::seconds(1)});
              },
              {"sh did not finish within 1 s", "thinking"});
}

TEST(ForeignProgram, IsKilledTogetherWithItsChildren) {
  const test::TemporaryDirectory directory;
  const std::string file = directory / "late";
  expectError(
      ExitCode::failed,
      [&] {
        runToItsEnd({.words = {"sh", "-c", "(sleep 3; echo late > \"$1\") & wait", "sh", file},
                     .package = "dash",
                     .patience = std::chrono::seconds(1)});
      },
      {"sh did not finish"});
  std::this_thread::sleep_for(std::chrono::seconds(4));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(ForeignProgram, RunsIfThisProcessHasNoStandardStreams) {
  const int in = dup(STDIN_FILENO);
  close(STDIN_FILENO);
  const Ran ran = runToItsEnd({.words = {"cat"}, .package = "coreutils", .input = "asked"});
  dup2(in, STDIN_FILENO);
  close(in);
  EXPECT_EQ(ran.out, "asked");
}

TEST(ForeignProgram, ReportsTheSignalThatEndedIt) {
  expectError(ExitCode::failed,
              [] {
                runToItsEnd({.words = {"sh", "-c", "kill -9 $$"}, .package = "dash"});
              },
              {"sh was killed by signal 9"});
}

}  // namespace
}  // namespace palpate
