#include "common/base/terminal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

namespace palpate {
namespace {

std::string page(int lines, std::size_t width) {
  std::string text;
  for (int n = 0; n < lines; ++n) text += std::string(width, 'x') + '\n';
  return text;
}

TEST(Fitted, LeavesAPageThatFitsAsItIs) {
  EXPECT_EQ(fitted(page(23, 80), {24, 80}), page(23, 80));
  EXPECT_EQ(fitted("", {24, 80}), "\n");
}

TEST(Fitted, FitsTheWindowAndCountsTheLinesLeftOut) {
  for (std::size_t rows = 1; rows < 60; ++rows)
    for (const std::size_t columns : {1u, 20u, 80u, 200u}) {
      const std::string text = fitted(page(50, 100), {rows, columns});
      std::istringstream in(text);
      for (std::string line; std::getline(in, line);) EXPECT_LE(line.size(), columns);
      EXPECT_LT(std::ranges::count(text, '\n'), std::max<std::ptrdiff_t>(rows, 3));
    }
  EXPECT_NE(fitted(page(50, 10), {24, 80}).find("... 28 more lines"), std::string::npos);
}

TEST(Wrapped, BreaksLinesAtBlanksAndIndentsTheRest) {
  EXPECT_EQ(wrapped("topic  one two three\nshort\n", 13, 7),
            "topic  one\n       two\n       three\nshort\n");
  EXPECT_EQ(wrapped("topic  one-word-that-is-wide end\n", 13, 7),
            "topic  one-word-that-is-wide\n       end\n")
      << "words stay whole";
  EXPECT_EQ(wrapped("", 13, 7), "");
}

}  // namespace
}  // namespace palpate
