#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "common/scene/scene.hpp"
#include "tests/support/command.hpp"
#include "tests/support/shell_script.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

using test::CommandResult;
using ::testing::HasSubstr;

/// A copy of the front command beside programs that only print their arguments.
class FrontCommand : public ::testing::Test {
 protected:
  FrontCommand() {
    std::filesystem::copy_file(std::string(PALPATE_BIN_DIR) + "/palpate", directory / "palpate");
    for (const char* program : {"palpate-worker", "palpate-scheduler"})
      test::writeScript(directory / program, "echo \"$(basename $0):$*\"\nexit 3");
  }
  CommandResult palpate(const std::string& arguments) {
    return test::runCommand((directory / "palpate").string() + " " + arguments);
  }
  test::TemporaryDirectory directory;
};

TEST_F(FrontCommand, StartsTheProgramBesideItAndReturnsItsExitCode) {
  const CommandResult result = palpate("build 'a b.toml' -j 2");
  EXPECT_EQ(result.output, "palpate-scheduler:build a b.toml -j 2\n");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(palpate("check x").output, "palpate-worker:check x\n");
}

TEST_F(FrontCommand, HoldsOpenBlasToOneThreadBeforeItIsLoaded) {
  std::ofstream(directory / "palpate-worker") << "#!/bin/sh\necho $OPENBLAS_NUM_THREADS\n";
  EXPECT_EQ(palpate("check x").output, "1\n");
}

TEST_F(FrontCommand, NamesAMemoryLimitThatWouldHangOpenBlas) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own memory does not fit under the limit";
#endif
  for (const char* verb : {"check", "work"}) {
    const test::CommandResult refused = test::runCommand(
        "(ulimit -v 300000; '" + (directory / "palpate").string() + "' " + verb + " x 2>&1)");
    EXPECT_EQ(refused.exit_code, 1) << refused.output;
    EXPECT_THAT(refused.output, testing::HasSubstr("ulimit -v"));
  }
}

TEST_F(FrontCommand, AsksTheSchedulerToCheckADirectoryAndTheWorkerToCheckAScene) {
  std::filesystem::create_directory(directory / "x.h5.state");
  std::filesystem::create_directory(directory / "check");
  const std::string state = (directory / "x.h5.state").string();
  EXPECT_EQ(palpate("check " + state + " --json").output,
            "palpate-scheduler:check " + state + " --json\n");
  EXPECT_EQ(palpate("check --repair " + state).output,
            "palpate-scheduler:check --repair " + state + "\n");
  EXPECT_EQ(palpate("check x.toml").output, "palpate-worker:check x.toml\n");
  EXPECT_EQ(palpate("solve " + state).output, "palpate-worker:solve " + state + "\n");
  EXPECT_EQ(test::runCommand("cd " + directory.path().string() + " && ./palpate check").output,
            "palpate-worker:check\n")
      << "the verb itself is not a directory";
}

TEST_F(FrontCommand, WorksThroughALinkElsewhere) {
  const test::TemporaryDirectory elsewhere;
  std::filesystem::create_symlink(directory / "palpate", elsewhere / "palpate");
  EXPECT_EQ(test::runCommand((elsewhere / "palpate").string() + " work").output,
            "palpate-worker:work\n");
}

TEST_F(FrontCommand, SaysWhichProgramIsMissing) {
  const CommandResult result = palpate("query x.h5");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr("palpate-answers"), HasSubstr("cmake --build")));
}

TEST_F(FrontCommand, PrintsTheOverviewOfAllVerbsWithoutArguments) {
  const CommandResult result = palpate("--help");
  EXPECT_EQ(result.exit_code, 0);
  for (const char* verb : {"build", "serve",    "fleet", "status",  "stop",   "pause", "resume",
                           "seal",  "priority", "retry", "explain", "events", "work",  "follow",
                           "solve", "check",    "query", "verify",  "mesh",   "new"})
    EXPECT_THAT(result.output, HasSubstr(std::string("\n  ") + verb + " "));
  EXPECT_EQ(palpate("").output, result.output);
  EXPECT_EQ(palpate("help").output, result.output);
}

TEST_F(FrontCommand, TheSceneInTheOverviewIsValid) {
  const std::string text = palpate("--help").output;
  const std::size_t begin = text.find("  mesh = ");
  ASSERT_NE(begin, std::string::npos);
  // The lines of the scene are indented; the line after the scene is not.
  std::size_t end = begin;
  while (text[text.find('\n', end) + 1] == ' ') end = text.find('\n', end) + 1;
  end = text.find('\n', end);
  EXPECT_NO_THROW(parseScene(text.substr(begin, end - begin), "overview"));
}

TEST_F(FrontCommand, HelpVerbShowsTheProgramsHelp) {
  EXPECT_EQ(palpate("help solve").output, "palpate-worker:solve --help\n");
}

TEST_F(FrontCommand, PrintsItsVersion) {
  EXPECT_THAT(palpate("--version").output, ::testing::StartsWith("palpate 0."));
}

TEST_F(FrontCommand, RefusesAnUnknownVerbNamingTheNearest) {
  const CommandResult near = palpate("biuld x.toml");
  EXPECT_EQ(near.exit_code, 2);
  EXPECT_THAT(near.output, HasSubstr("did you mean \"build\""));
  const CommandResult far = palpate("frobnicate");
  EXPECT_EQ(far.exit_code, 2);
  EXPECT_THAT(far.output, HasSubstr("view or device"));
}

}  // namespace
}  // namespace palpate
