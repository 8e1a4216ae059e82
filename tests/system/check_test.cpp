#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/command.hpp"
#include "tests/system/small_build.hpp"

/// `palpate check` of a state directory, as a user calls it.

namespace palpate {
namespace {

using test::CommandResult;
using ::testing::AllOf;
using ::testing::HasSubstr;

struct CheckStateTest : test::SmallBuild {
  CommandResult check(const std::string& arguments) {
    return test::runCommand("cd '" + directory.path().string() +
                            "' && '" PALPATE_BIN_DIR "/palpate' check " + arguments);
  }
  void flip(std::streamoff byte) const {
    std::fstream file(directory / "out.h5.state/segment-000001.dat",
                      std::ios::binary | std::ios::in | std::ios::out);
    file.seekg(byte);
    const int there = file.get();
    file.seekp(byte);
    file.put(static_cast<char>(there ^ 4));
  }
};

TEST_F(CheckStateTest, TellsDamageByItsExitCodeAndRepairsItSoThatTheBuildGoesOn) {
  auto build = startBuild("out.h5", "2");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 50000));
  // On a busy machine it would be done before it is looked at twice.
  build->signal(SIGSTOP);
  const CommandResult beside = check("out.h5.state");
  EXPECT_EQ(beside.exit_code, 0) << beside.output;
  EXPECT_THAT(beside.output, HasSubstr("works there"));
  const CommandResult refused = check("out.h5.state --repair");
  EXPECT_EQ(refused.exit_code, 1) << refused.output;
  EXPECT_THAT(refused.output, HasSubstr("is in use by process"));
  build->stop(SIGKILL);

  EXPECT_EQ(check("out.h5.state").exit_code, 0) << "a kill is no damage";
  for (const std::streamoff byte : {10, 15000, 40000}) flip(byte);
  const CommandResult damaged = check("out.h5.state --json");
  EXPECT_EQ(damaged.exit_code, 1) << damaged.output;
  EXPECT_THAT(damaged.output, AllOf(HasSubstr("\"whole\":false"), HasSubstr("\"byte\":0,")));
  const CommandResult repaired = check("out.h5.state --repair");
  EXPECT_EQ(repaired.exit_code, 0) << repaired.output;
  EXPECT_THAT(repaired.output, AllOf(HasSubstr("repaired   3 damaged"), HasSubstr("whole: ")));
  EXPECT_EQ(check("out.h5.state").exit_code, 0);

  auto again = startBuild("out.h5", "2");
  expectFinished(*again);
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
  EXPECT_EQ(check("out.h5.state").exit_code, 0);
}

TEST_F(CheckStateTest, RefusesWhatIsNoStateDirectoryAndStillChecksScenes) {
  std::filesystem::create_directory(directory / "folder");
  const CommandResult folder = check("folder");
  EXPECT_EQ(folder.exit_code, 2);
  EXPECT_THAT(folder.output, HasSubstr("folder: is not a state directory"));
  EXPECT_EQ(check("folder --repair").exit_code, 2);
  EXPECT_TRUE(std::filesystem::is_empty(directory / "folder"));
  EXPECT_EQ(check("cube.toml").exit_code, 0);
  EXPECT_EQ(check("missing.toml").exit_code, 2);
}

}  // namespace
}  // namespace palpate
