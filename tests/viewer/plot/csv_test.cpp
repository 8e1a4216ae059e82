#include "viewer/plot/csv.hpp"

#include <gtest/gtest.h>

namespace palpate {
namespace {

TEST(Csv, QuotesCellsThatHoldCommasOrQuotes) {
  EXPECT_EQ(csvLine({"way, mm", "b \"c\"", "d"}), "\"way, mm\",\"b \"\"c\"\"\",d\n");
}

TEST(Csv, KeepsEmptyCells) { EXPECT_EQ(csvLine({"", "x", ""}), ",x,\n"); }

}  // namespace
}  // namespace palpate
