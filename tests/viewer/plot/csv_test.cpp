#include "viewer/plot/csv.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace palpate {
namespace {

TEST(Csv, HasThePointsOfAPlotUnderTheLabelsOfItsAxes) {
  Plot plot = {.title = "t", .x = {"way, mm"}, .y = {"force, N"}, .series = {{.label = "a"}}};
  plot.series[0].add(1.5, -2);
  plot.series[0].add(3, std::nan(""));
  plot.series.push_back({.label = "b \"c\""});
  plot.series[1].add(4, 0.1);
  EXPECT_EQ(csvOf(plot),
            "series,\"way, mm\",\"force, N\"\na,1.5,-2\na,3,\n\"b \"\"c\"\"\",4,0.1\n");
}

TEST(Csv, KeepsEmptyCells) { EXPECT_EQ(csvLine({"", "x", ""}), ",x,\n"); }

}  // namespace
}  // namespace palpate
