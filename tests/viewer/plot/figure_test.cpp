#include "viewer/plot/figure.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "viewer/plot/csv.hpp"

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Plot plotOf(const std::string& title) {
  Plot plot = {
      .title = title, .x = {"way, mm"}, .y = {"force, N"}, .series = {{.label = "exact & solved"}}};
  plot.series[0].add(1, 2, "a \"note\" <here>");
  plot.series[0].add(3, 4, "100 % of it");
  return plot;
}

/// What a browser makes of a data: address.
std::string contentOf(const std::string& address) {
  std::string text;
  for (std::size_t n = address.find(',') + 1; n < address.size(); ++n)
    if (address[n] == '%') {
      text += static_cast<char>(std::stoi(address.substr(n + 1, 2), nullptr, 16));
      n += 2;
    } else {
      text += address[n];
    }
  return text;
}

/// The addresses behind links that save as `file`.
std::string addressOf(const std::string& html, const std::string& file) {
  const std::size_t link = html.find("<a download=\"" + file + "\"");
  if (link == std::string::npos) return "";
  const std::size_t begin = html.find("href=\"", link) + 6;
  return html.substr(begin, html.find('"', begin) - begin);
}

TEST(Figure, IsNumberedInTheOrderOfThePageAndItsPanelsAreLettered) {
  FigureNumbers numbers("liver");
  const std::string first =
      numbers.html({.caption = "One.", .panels = {panelOf(plotOf("only"))}, .layout = "single"});
  const std::string second = numbers.html(
      {.caption = "Two.", .panels = {panelOf(plotOf("left")), panelOf(plotOf("right"), "words")}});
  EXPECT_THAT(first, AllOf(HasSubstr("<b>Figure 1.</b> One."), Not(HasSubstr("<b>a</b>"))));
  EXPECT_THAT(second, AllOf(HasSubstr("id=\"figure-2\""), HasSubstr("<b>Figure 2.</b> Two."),
                            HasSubstr("<b>a</b>"), HasSubstr("<b>b</b> <span>words</span>")));
  EXPECT_EQ(numbers.count(), 2);
}

TEST(Figure, OffersEveryPanelAsADrawingAndItsNumbers) {
  FigureNumbers numbers("liver");
  const Plot plot = plotOf("right");
  const std::string html =
      numbers.html({.caption = "", .panels = {panelOf(plotOf("left")), panelOf(plot)}});
  EXPECT_EQ(contentOf(addressOf(html, "liver-figure-1b.csv")), csvOf(plot));
  const std::string svg = contentOf(addressOf(html, "liver-figure-1b.svg"));
  EXPECT_THAT(svg, AllOf(StartsWith("<svg xmlns=\"http://www.w3.org/2000/svg\""),
                         HasSubstr("<style>"), HasSubstr(">right<"),
                         // The page has a legend of its own; a file does not lie beside it.
                         HasSubstr("exact &amp; solved"), HasSubstr("100 % of it")));
}

TEST(Figure, FilesHaveRoomForTheirLegend) {
  const Panel panel = panelOf(plotOf("t"));
  EXPECT_GT(panel.key.height, 0);
  EXPECT_THAT(svgFile(panel.svg, panel.key),
              HasSubstr(fmt::format("height=\"{:g}\"", 340 + panel.key.height)));
}

TEST(Figure, NamesOfFilesSuitEverySystem) {
  FigureNumbers numbers("../a b<c>:ü.");
  EXPECT_THAT(numbers.html({.caption = "", .panels = {panelOf(plotOf("t"))}}),
              HasSubstr("download=\"a-b-c-figure-1.svg\""));
  FigureNumbers unnamed("…");
  EXPECT_THAT(unnamed.html({.caption = "", .panels = {panelOf(plotOf("t"))}}),
              HasSubstr("download=\"palpate-figure-1.svg\""));
}

TEST(Figure, AddressesHoldEveryByteAndEndNoAttribute) {
  std::string bytes;
  for (int byte = 1; byte < 256; ++byte) bytes += static_cast<char>(byte);
  const std::string address = dataAddress("text/csv", bytes);
  EXPECT_EQ(contentOf(address), bytes);
  EXPECT_EQ(address.find_first_of("\"'<>&#\n"), std::string::npos);
}

}  // namespace
}  // namespace palpate
