#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/system/small_build.hpp"

/// `palpate check` of a state directory, called as by a user.

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct CheckStateTest : test::SmallBuild {
  std::string check(const std::string& arguments, int code) const {
    return told("check " + arguments, code);
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

TEST_F(CheckStateTest, ReportsDamageByExitCodeAndRepairsItForTheBuild) {
  auto build = startBuild("out.h5", "2");
  ASSERT_TRUE(journalGrows(*build, "out.h5.state", 50000));
  // Stop the build, which might otherwise end before the second check on a busy machine.
  build->signal(SIGSTOP);
  EXPECT_THAT(check("out.h5.state", 0), HasSubstr("is writing there"));
  EXPECT_THAT(check("out.h5.state --repair", 1), HasSubstr("is in use by process"));
  build->stop(SIGKILL);

  check("out.h5.state", 0);  // a kill is not damage
  for (const std::streamoff byte : {10, 15000, 40000}) flip(byte);
  EXPECT_THAT(check("out.h5.state --json", 1),
              AllOf(HasSubstr("\"whole\":false"), HasSubstr("\"byte\":0,")));
  EXPECT_THAT(check("out.h5.state --repair", 0), HasSubstr("3 damaged"));
  check("out.h5.state", 0);

  auto again = startBuild("out.h5", "2");
  expectFinished(*again);
  EXPECT_EQ(test::contentOf(directory / "out.h5"), undisturbed());
  check("out.h5.state", 0);
}

TEST_F(CheckStateTest, RefusesOtherDirectoriesAndStillChecksScenes) {
  std::filesystem::create_directory(directory / "folder");
  EXPECT_THAT(check("folder", 2), HasSubstr("folder: is not a state directory"));
  check("folder --repair", 2);
  EXPECT_TRUE(std::filesystem::is_empty(directory / "folder"));
  check("cube.toml", 0);
  check("missing.toml", 2);
}

}  // namespace
}  // namespace palpate
