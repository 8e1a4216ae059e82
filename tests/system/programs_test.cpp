#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/command.hpp"
#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

TEST(Programs, NoProgramLinksOpenMpiAndOnlyTheClientOpenGl) {
  int programs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(PALPATE_BIN_DIR)) {
    if (!entry.path().filename().string().starts_with("palpate")) continue;
    const test::CommandResult libraries = test::runCommand("ldd '" + entry.path().string() + "'");
    EXPECT_EQ(libraries.exit_code, 0) << libraries.output;
    EXPECT_THAT(libraries.output, ::testing::HasSubstr("libc.so")) << entry.path();
    EXPECT_THAT(
        libraries.output,
        ::testing::Not(::testing::ContainsRegex("libmpi|openmpi|open-rte|open-pal|libmpich")))
        << entry.path();
    EXPECT_EQ(libraries.output.find("libglfw") != std::string::npos,
              entry.path().filename() == "palpate-viewer")
        << entry.path();
    ++programs;
  }
  EXPECT_GE(programs, 1) << "nothing is built in " << PALPATE_BIN_DIR;
}

TEST(Programs, NameTheLimitOfTheSystemThatStopsThem) {
  for (const std::string limit : {"ulimit -n 12", "ulimit -f 1"}) {
    const test::TemporaryDirectory directory;
    const test::CommandResult result =
        test::runCommand("(cd '" + directory.path().string() + "' && " + limit +
                         " && " PALPATE_BIN_DIR "/palpate new organ --mesh " PALPATE_SOURCE_DIR
                         "/deploy/scenes/liver/liver-500.msh)");
    EXPECT_EQ(result.exit_code, 1) << result.output;
    EXPECT_THAT(result.output, ::testing::HasSubstr(limit.substr(0, 9))) << limit;
  }
}

TEST(Programs, NameAMemoryLimitUnderWhichTheyCannotSolve) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own memory does not fit under the limit";
#endif
  const std::string scene = PALPATE_SOURCE_DIR "/deploy/scenes/liver/liver.toml";
  const test::TemporaryDirectory directory;
  // OpenBLAS 0.3.29 and later wait for memory before a worker's main() runs, so `palpate` looks
  // first. The scheduler looks for the workers that it starts, also without `palpate`.
  const std::vector<std::string> commands = {
      "palpate-scheduler build -j 1 -o '" + (directory / "liver.h5").string() + "' " + scene,
      "palpate work --alone --insecure --give-up 5", "palpate check " + scene,
      "palpate solve --displacement 0 0 -0.001 " + scene};
  for (const std::string& command : commands) {
    const test::CommandResult result =
        test::runCommand("(ulimit -v 300000; timeout 60 " PALPATE_BIN_DIR "/" + command + ")");
    EXPECT_EQ(result.exit_code, 1) << command << ": " << result.output;
    EXPECT_THAT(result.output, ::testing::HasSubstr("ulimit -v")) << command;
  }
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Programs, FailIfTheirOutputCannotBeWritten) {
  const std::string scene = std::string(PALPATE_SOURCE_DIR) + "/deploy/scenes/liver/liver.toml";
  for (const std::string verb : {"doctor", "check", "solve --displacement 0.001 0 0"}) {
    const std::string command = std::string(PALPATE_BIN_DIR "/palpate ") + verb +
                                (verb == "doctor" ? "" : " '" + scene + "'");
    const test::CommandResult full = test::runCommand("(" + command + " > /dev/full)");
    EXPECT_EQ(full.exit_code, 1) << command;
    EXPECT_THAT(full.output, ::testing::HasSubstr("standard output")) << command;
  }
}

}  // namespace
}  // namespace palpate
