#include "common/base/text.hpp"

#include <gtest/gtest.h>

#include "tests/support/command.hpp"

namespace palpate {
namespace {

TEST(Printable, HasNoCursorMovesAndNoLineBreaks) {
  EXPECT_EQ(printable("node-17"), "node-17");
  EXPECT_EQ(printable("\x1b[2Jall is\nwell\x7f\xff"), "?[2Jall is?well??");
  EXPECT_EQ(printable(std::string(1000, 'x')), std::string(64, 'x'));
  EXPECT_EQ(printable(std::string(1000, 'x'), 3), "xxx");
}

TEST(ShellWord, IsQuotedOnlyIfNecessary) {
  EXPECT_EQ(shellWord("build/liver-500.h5"), "build/liver-500.h5");
  EXPECT_EQ(shellWord("my organ.stl"), "'my organ.stl'");
  EXPECT_EQ(shellWord("-y.msh"), "./-y.msh");
  EXPECT_EQ(shellWord(""), "''");
}

TEST(ShellWord, IsReadBackUnchangedByAShell) {
  for (const std::string name : {"o'brien.msh", "a\"b$HOME`id`\\.msh", "two\nlines", "Länge 1", "*",
                                 "~root", "a;b", "#x", "'"})
    EXPECT_EQ(test::runCommand("printf %s " + shellWord(name)).output, name);
}

TEST(Text, ReplacesEveryPlaceOnceEvenByTextThatContainsIt) {
  EXPECT_EQ(replacedAll("%a and %a", "%a", "x%a"), "x%a and x%a");
  EXPECT_EQ(replacedAll("none", "%a", "b"), "none");
}

}  // namespace
}  // namespace palpate
