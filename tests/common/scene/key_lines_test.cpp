#include "common/scene/key_lines.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(KeyLines, AnOmittedKeyHasTheLineOfItsTable) {
  const KeyLines lines = {4, {{"group", 6}}};
  EXPECT_EQ(lines.of("group"), 6);
  EXPECT_EQ(lines.of("box"), 4);
  EXPECT_EQ(KeyLines{}.of("group"), 0);
}

TEST(KeyLines, AnErrorHasTheLineOfTheInnermostTable) {
  const auto refuse = [] {
    atLine(3, [] { atLine(7, [] { throw badInput("there is no such group"); }); });
  };
  try {
    refuse();
    FAIL() << "no exception";
  } catch (const SceneError& error) {
    EXPECT_EQ(error.line(), 7);
    EXPECT_EQ(error.exitCode(), ExitCode::usage);
  }
}

}  // namespace
}  // namespace palpate
