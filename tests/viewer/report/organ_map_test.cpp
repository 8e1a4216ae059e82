#include "viewer/report/organ_map.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <regex>

#include "common/base/index.hpp"
#include "tests/support/meshes.hpp"

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

std::ptrdiff_t countOf(const std::string& text, const std::string& what) {
  const std::regex pattern(what);
  return std::distance(std::sregex_iterator(text.begin(), text.end(), pattern),
                       std::sregex_iterator());
}

std::vector<Panel> panels(const Mesh& mesh, const OrganMap& map) {
  return panelsOf(mesh, map, ColourScale({0.01, 1}), ColourUnit::newtons);
}

TEST(OrganMap, ShowsEachSideOfTheBodyFromOneOfTheSides) {
  const Mesh mesh = test::blobMesh();
  OrganMap map = {.values = "v"};
  map.on_triangles.assign(mesh.surface.size(), 0.1);
  const std::vector<Panel> shown = panels(mesh, map);
  ASSERT_EQ(shown.size(), 3U);
  const auto triangles = [&](std::size_t n) {
    return countOf(shown[n].svg, "0.1[0-9]* N</title>");
  };
  // What faces the front does not face away from it; edges on are seen from neither.
  EXPECT_EQ(triangles(0) + triangles(1), static_cast<std::ptrdiff_t>(mesh.surface.size()));
  EXPECT_THAT(shown[0].svg,
              AllOf(HasSubstr(ColourScale({0.01, 1}).colourOf(0.1)), HasSubstr(" mm</text>")));
}

TEST(OrganMap, PlacesWithoutAValueAreGreyAndDiscsAreOnTheSideThatTheyAreOn) {
  const Mesh mesh = test::blobMesh();
  OrganMap map = {.on_triangles = std::vector<double>(mesh.surface.size(), std::nan("")),
                  .values = "v"};
  // In the middle of a triangle, which faces one of the two sides.
  const auto& [a, b, c] = mesh.surface.front();
  map.marks = {{(mesh.nodes[at(a)] + mesh.nodes[at(b)] + mesh.nodes[at(c)]) / 3, 0.2, "tip <1>"}};
  const std::vector<Panel> shown = panels(mesh, map);
  EXPECT_THAT(shown[0].svg, Not(HasSubstr("#440154")));
  const std::string both = shown[0].svg + shown[1].svg;
  EXPECT_EQ(countOf(both, "<circle"), 1);
  EXPECT_THAT(both, HasSubstr("tip &lt;1&gt;"));
}

TEST(OrganMap, WhatIsAtACornerIsSeenFromEverySideOfIt) {
  const Mesh mesh = test::cubeMesh(0.1, 2);
  OrganMap map = {.values = "v"};
  for (int n = 0; n < 8; ++n)
    map.marks.push_back(
        {boundingBox(mesh).corner(static_cast<Eigen::AlignedBox3d::CornerType>(n)), 0.1, "corner"});
  for (const Panel& panel : panels(mesh, map)) EXPECT_GE(countOf(panel.svg, "<circle"), 4);
}

TEST(OrganMap, ItsNumbersAreAllPlacesWithTheirValues) {
  const Mesh mesh = test::tetrahedronMesh(0.3);
  const OrganMap map = {.on_triangles = {0.5, std::nan(""), 0.25, 1},
                        .marks = {{{0, 0, 0}, 2, "m"}},
                        .values = "bound (N)"};
  const Panel panel = panels(mesh, map).front();
  ASSERT_EQ(panel.data.size(), 1U);
  const std::string& csv = panel.data.front().text;
  EXPECT_TRUE(csv.starts_with("place,x (mm),y (mm),z (mm),bound (N)\ntriangle,"));
  EXPECT_EQ(std::ranges::count(csv, '\n'), 6);
  EXPECT_THAT(csv, HasSubstr("\nmark,0,0,0,2\n"));
}

TEST(OrganMap, TheScaleSaysWhatItsNumbersCount) {
  const ColourScale scale({0.01, 1});
  EXPECT_THAT(colourBar(scale, ColourUnit::share).svg, HasSubstr(">100 %<"));
  EXPECT_THAT(colourBar(scale, ColourUnit::newtons).svg, HasSubstr(">0.01 N<"));
  EXPECT_THAT(legendOfMap(scale, ColourUnit::share, ""), Not(HasSubstr("<circle")));
}

}  // namespace
}  // namespace palpate
