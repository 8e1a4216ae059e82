#include "viewer/plot/csv.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

TEST(Csv, QuotesCellsThatHoldCommasOrQuotes) {
  EXPECT_EQ(csvLine({"way, mm", "b \"c\"", "d"}), "\"way, mm\",\"b \"\"c\"\"\",d\n");
}

TEST(Csv, KeepsEmptyCells) { EXPECT_EQ(csvLine({"", "x", ""}), ",x,\n"); }

TEST(Csv, LeavesOutNumbersThatDoNotExist) {
  EXPECT_EQ(csvNumber(-0.1), "-0.1");
  EXPECT_EQ(csvNumber(std::nan("")), "");
}

}  // namespace
}  // namespace palpate
