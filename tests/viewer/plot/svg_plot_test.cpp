#include "viewer/plot/svg_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace palpate {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<::testing::Matcher<double>> near(const std::vector<double>& values) {
  std::vector<::testing::Matcher<double>> matchers;
  for (const double value : values) matchers.emplace_back(DoubleNear(value, 1e-12));
  return matchers;
}

Plot samplePlot() {
  Plot plot;
  plot.title = "<error> & \"time\"";
  plot.x = {"ns", true};
  plot.y = {"N", false};
  plot.series.push_back({.label = "potential",
                         .x = {1, 10, std::nan(""), 100, 0},
                         .y = {1, 2, 3, std::nan(""), 5},
                         .notes = {"a<b"},
                         .style = seriesStyle(0)});
  return plot;
}

TEST(SvgPlot, LinearTicksAreRoundNumbersWithin) {
  EXPECT_THAT(linearTicks(0, 1), ::testing::ElementsAreArray(near({0, 0.2, 0.4, 0.6, 0.8, 1})));
  EXPECT_THAT(linearTicks(-61, 62), ::testing::ElementsAreArray(near({-50, 0, 50})));
  EXPECT_THAT(linearTicks(0.1003, 0.1009),
              ::testing::Each(::testing::AllOf(::testing::Ge(0.1003), ::testing::Le(0.1009))));
  EXPECT_THAT(linearTicks(2, 2), ElementsAre(2));
}

TEST(SvgPlot, LogarithmicTicksArePowersOfTenAndMoreOfThemWhereThereAreFew) {
  EXPECT_THAT(logarithmicTicks(1e-4, 1),
              ::testing::ElementsAreArray(near({1e-4, 1e-3, 1e-2, 1e-1, 1})));
  EXPECT_THAT(logarithmicTicks(15, 250), ::testing::ElementsAreArray(near({20, 50, 100, 200})));
  EXPECT_THAT(logarithmicTicks(3.5, 6.5), ::testing::ElementsAreArray(near({4, 5, 6})));
  EXPECT_THAT(logarithmicTicks(0.0105, 0.0149),
              ::testing::ElementsAreArray(near({0.011, 0.012, 0.013, 0.014})));
  EXPECT_GE(logarithmicTicks(0.0093, 0.0113).size(), 2U);
  EXPECT_LE(logarithmicTicks(1e-14, 1e2).size(), 9U);
  EXPECT_GE(logarithmicTicks(1e-14, 1e2).size(), 4U);
}

TEST(SvgPlot, LabelsAreShort) {
  EXPECT_EQ(tickLabel(0), "0");
  EXPECT_EQ(tickLabel(0.02), "0.02");
  EXPECT_EQ(tickLabel(-50), "-50");
  EXPECT_EQ(tickLabel(1000), "1000");
  EXPECT_EQ(tickLabel(1e-5), "10⁻⁵");
  EXPECT_EQ(tickLabel(2e6), "2·10⁶");
}

TEST(SvgPlot, TextCannotBecomeMarkup) {
  const std::string svg = svgOf(samplePlot());
  EXPECT_THAT(svg, HasSubstr("&lt;error&gt; &amp; &quot;time&quot;"));
  EXPECT_THAT(svg, HasSubstr("<title>a&lt;b</title>"));
}

TEST(SvgPlot, LeavesOutWhatIsNoNumberOrHasNoLogarithm) {
  const std::string svg = svgOf(samplePlot());
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  Plot empty = samplePlot();
  empty.series.clear();
  EXPECT_THAT(svgOf(empty), Not(HasSubstr("nan")));
}

TEST(SvgPlot, AConstantSeriesHasAPlotToo) {
  Plot plot = samplePlot();
  plot.series = {{.label = "one", .x = {5}, .y = {0}, .style = seriesStyle(1)}};
  const std::string svg = svgOf(plot);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
}

TEST(SvgPlot, TenCurvesLookDifferent) {
  std::set<std::string> looks;
  for (std::size_t n = 0; n < 10; ++n) {
    const SeriesStyle style = seriesStyle(n);
    looks.insert(style.colour + markerAt(0, 0, style, 4));
  }
  EXPECT_EQ(looks.size(), 10U);
}

}  // namespace
}  // namespace palpate
