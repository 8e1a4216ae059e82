#include "viewer/first_start.hpp"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>

#include "tests/support/temporary_directory.hpp"

namespace palpate {
namespace {

class FirstStartTest : public testing::Test {
 protected:
  FirstStartTest() { setenv("XDG_STATE_HOME", (directory / "state").c_str(), 1); }
  ~FirstStartTest() override {
    unsetenv("XDG_STATE_HOME");
    setenv("HOME", home.c_str(), 1);
  }

  const std::string home = getenv("HOME") != nullptr ? getenv("HOME") : "/";
  test::TemporaryDirectory directory;
};

TEST_F(FirstStartTest, IsTheFirstOnceAndNeverAgain) {
  EXPECT_TRUE(firstStart());
  EXPECT_FALSE(firstStart());
  EXPECT_TRUE(std::filesystem::exists(directory / "state/palpate/tutorial-shown"));
}

TEST_F(FirstStartTest, IsOfAPersonsHomeWhereNothingElseIsSaid) {
  unsetenv("XDG_STATE_HOME");
  setenv("HOME", directory.path().c_str(), 1);
  EXPECT_TRUE(firstStart());
  EXPECT_FALSE(firstStart());
  EXPECT_TRUE(std::filesystem::exists(directory / ".local/state/palpate/tutorial-shown"));
}

TEST_F(FirstStartTest, IsNoneWhereItCannotBeRemembered) {
  std::ofstream(directory / "state") << "a file";
  EXPECT_FALSE(firstStart());
  unsetenv("XDG_STATE_HOME");
  unsetenv("HOME");
  EXPECT_FALSE(firstStart());
}

}  // namespace
}  // namespace palpate
