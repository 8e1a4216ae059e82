#include "common/base/displacement_input.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <sstream>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using test::expectBadInput;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<Eigen::Vector3d> read(const std::vector<std::string>& words,
                                  const std::string& lines = "") {
  std::istringstream input(lines);
  std::vector<Eigen::Vector3d> read;
  forEachTouch({}, words, input, 0.1,
               [&](const TouchInput& touch) { read.push_back(touch.displacement); });
  return read;
}

/// The values that the option takes from a command line.
std::vector<std::string> optionFrom(const std::vector<std::string>& arguments) {
  CLI::App app;
  std::vector<std::string> words;
  std::string file;
  app.add_option("file", file);
  addDisplacementOption(app, words);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  app.parse(reversed);
  return words;
}

TEST(DisplacementInput, ReadsThreeNumbersFromTheCommandLine) {
  EXPECT_THAT(read({"-0.01", "+2e-3", "0"}), ElementsAre(Eigen::Vector3d(-0.01, 0.002, 0)));
}

TEST(DisplacementInput, ReadsOneDisplacementPerLineSkippingCommentsAndBlanks) {
  EXPECT_THAT(read({"-"}, "1 2 3\n\n# x y z\n  -.5,\t0 , 1e-3\r\n4,5,6"),
              ElementsAre(Eigen::Vector3d(1, 2, 3), Eigen::Vector3d(-0.5, 0, 0.001),
                          Eigen::Vector3d(4, 5, 6)));
  EXPECT_TRUE(read({"-"}).empty());
}

TEST(DisplacementInput, NamesAnInvalidNumberAndItsLine) {
  for (const char* line :
       {"0 0", "0 0 0 0", "0 0 x", "0 nan 0", "-inf 0 0", "0 0 1e999", "0 0 0.1m", "0x1 0 0"})
    expectBadInput([&] { read({"-"}, std::string("0 0 0\n\n") + line + "\n0 0 0\n"); },
                   {"standard input, line 3"});
  expectBadInput([] { read({"0", "0", "nan"}); }, {"--displacement", "\"nan\"", "finite"});
  expectBadInput([] { read({"0", "0"}); }, {"--displacement", "three numbers", "found 2"});
}

TEST(DisplacementInput, RecognisesMillimetresGivenAsMetres) {
  EXPECT_TRUE(looksLikeMillimetres({13, 7, -21}, 0.1));
  EXPECT_TRUE(looksLikeMillimetres({0, 0.5, 0}, 0.1));
  EXPECT_FALSE(looksLikeMillimetres({0.013, 0.007, -0.021}, 0.1));
  EXPECT_FALSE(looksLikeMillimetres({0.2, 0, 0}, 0.1)) << "outside the ball, which is allowed";
  EXPECT_FALSE(looksLikeMillimetres({1300, 0, 0}, 0.1)) << "nor in millimetres";
}

TEST(DisplacementInput, WarnsOfMillimetresOnceAndContinues) {
  testing::internal::CaptureStdout();  // where spdlog logs by default
  EXPECT_EQ(read({"-"}, "0 0 0.01\n13 7 -21\n14 7 -21\n").size(), 3u);
  const std::string logged = testing::internal::GetCapturedStdout();
  EXPECT_THAT(logged, HasSubstr("displacement (13, 7, -21) m"));
  EXPECT_THAT(logged, HasSubstr("millimetres, write (0.013, 0.007, -0.021)"));
  EXPECT_THAT(logged, Not(HasSubstr("(14")));
}

TEST(DisplacementInput, OptionTakesNegativeNumbersAndLeavesTheFollowingArgument) {
  EXPECT_THAT(optionFrom({"--displacement", "-1e-3", "0", "-2", "a.h5"}),
              ElementsAre("-1e-3", "0", "-2"));
  EXPECT_THAT(optionFrom({"a.h5", "--displacement", "-"}), ElementsAre("-"));
  EXPECT_THROW(optionFrom({"a.h5"}), CLI::ParseError);
}

}  // namespace
}  // namespace palpate
