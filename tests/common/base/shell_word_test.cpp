#include "common/base/shell_word.hpp"

#include <gtest/gtest.h>

#include "tests/support/command.hpp"

namespace palpate {
namespace {

TEST(ShellWord, IsQuotedWhereItNeedsToBe) {
  EXPECT_EQ(shellWord("build/liver-500.h5"), "build/liver-500.h5");
  EXPECT_EQ(shellWord("my organ.stl"), "'my organ.stl'");
  EXPECT_EQ(shellWord("-y.msh"), "./-y.msh");
  EXPECT_EQ(shellWord(""), "''");
}

TEST(ShellWord, IsWhatAShellMakesOfIt) {
  for (const std::string name : {"o'brien.msh", "a\"b$HOME`id`\\.msh", "two\nlines", "Länge 1", "*",
                                 "~root", "a;b", "#x", "'"})
    EXPECT_EQ(test::runCommand("printf %s " + shellWord(name)).output, name);
}

}  // namespace
}  // namespace palpate
