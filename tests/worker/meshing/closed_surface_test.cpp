#include "worker/meshing/closed_surface.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/support/expect_error.hpp"
#include "tests/worker/meshing/surfaces.hpp"

namespace palpate {
namespace {

using test::boxSurface;
using test::expectBadInput;
using test::insideOut;
using test::sphereSurface;
using test::together;
using test::torusSurface;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ClosedSurface closed(const TriangleSoup& soup, Bodies bodies = Bodies::only) {
  return closedSurface(soup, "organ.stl", bodies);
}

void refuses(const TriangleSoup& soup, std::initializer_list<std::string> words) {
  expectBadInput([&] { closed(soup); }, words);
}

/// A sphere of radius 1 whose triangles have separate corners, each off by up to `gap` / 2.
TriangleSoup tornSphere(double gap) {
  const TriangleSoup sphere = sphereSurface(1);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  TriangleSoup torn;
  for (const Triangle& t : sphere.triangles) {
    const auto first = static_cast<std::int32_t>(torn.points.size());
    for (const std::int32_t corner : t) {
      const Eigen::Vector3d off(number(random), number(random), number(random));
      torn.points.emplace_back(sphere.points[corner] + gap / 2 * off.normalized());
    }
    torn.triangles.push_back({first, first + 1, first + 2});
  }
  return torn;
}

/// An octahedron in the cube of edge 2; its corners are moved by `off` from the centres of the
/// cube's sides. The first triangle begins with a corner at `first` on a diagonal of the cube,
/// above one face; above the opposite face lies one at -`last`. Everything is scaled by `scale`.
TriangleSoup spikedOctahedron(double off, double first, double last, double scale) {
  TriangleSoup soup;
  for (int axis = 0; axis < 3; ++axis)
    for (const int sign : {1, -1}) {
      soup.points.emplace_back(Eigen::Vector3d::Constant(scale * off));
      soup.points.back()[axis] = scale * sign;
    }
  for (int face = 0; face < 8; ++face) {
    const Triangle t = {face & 1, 2 + (face >> 1 & 1), 4 + (face >> 2)};
    if (face != 0 && face != 7) {
      soup.triangles.push_back(t);
      continue;
    }
    const auto tip = static_cast<std::int32_t>(soup.points.size());
    soup.points.emplace_back(Eigen::Vector3d::Constant(scale * (face == 0 ? first : -last)));
    for (int i = 0; i < 3; ++i) soup.triangles.push_back({tip, t[i], t[(i + 1) % 3]});
  }
  return soup;
}

TEST(ClosedSurface, SplitsTheNeighbourOfATriangleWithoutArea) {
  TriangleSoup soup = boxSurface({1, 1, 1}, 1);
  // One edge of a side gets a corner in its middle, but only in one of its two triangles.
  const Triangle divided = soup.triangles[0];
  const auto middle = static_cast<std::int32_t>(soup.points.size());
  soup.points.emplace_back((soup.points[divided[0]] + soup.points[divided[1]]) / 2);
  soup.triangles[0] = {divided[0], middle, divided[2]};
  soup.triangles.push_back({middle, divided[1], divided[2]});
  soup.triangles.push_back({divided[0], divided[1], middle});
  const ClosedSurface surface = closed(soup);
  EXPECT_NEAR(surface.volume, 1, 1e-12);
  EXPECT_EQ(surface.triangles.size(), 14u);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("three corners on a line")));
}

TEST(ClosedSurface, SoundBodiesAreKeptUnchanged) {
  for (const TriangleSoup& soup : {boxSurface({2, 3, 4}), sphereSurface(1), torusSurface(3, 1)}) {
    const ClosedSurface surface = closed(soup);
    EXPECT_EQ(surface.triangles.size(), soup.triangles.size());
    EXPECT_EQ(surface.points.size(), soup.points.size());
    EXPECT_THAT(surface.notes, IsEmpty());
    EXPECT_THAT(surface.cavities, IsEmpty());
  }
  const ClosedSurface box = closed(boxSurface({2, 3, 4}));
  EXPECT_NEAR(box.volume, 24, 1e-12);
  EXPECT_NEAR(box.area, 52, 1e-12);
}

TEST(ClosedSurface, MergesTheCornersThatAnStlRepeats) {
  const TriangleSoup box = boxSurface({1, 1, 1});
  TriangleSoup soup;
  for (const Triangle& t : box.triangles) {
    const auto first = static_cast<std::int32_t>(soup.points.size());
    for (const std::int32_t corner : t) soup.points.push_back(box.points[corner]);
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(closed(soup).points.size(), box.points.size());
  // Coordinates rounded to six digits.
  for (std::size_t n = 0; n < soup.points.size(); n += 2) soup.points[n][0] += 5e-7;
  const ClosedSurface surface = closed(soup);
  EXPECT_EQ(surface.points.size(), box.points.size());
  EXPECT_THAT(surface.notes, Contains(HasSubstr("merged: 25 corners")));
}

TEST(ClosedSurface, IgnoresUnusedPointsInItsSize) {
  TriangleSoup soup = test::boxSurface({1, 1, 1}, 2);
  const std::size_t points = closedSurface(soup, "box", Bodies::only).points.size();
  soup.points.emplace_back(1e6, 0, 0);
  EXPECT_EQ(closedSurface(soup, "box", Bodies::only).points.size(), points);
}

TEST(ClosedSurface, LeavesOutTrianglesWithoutAreaAndRepeatedOnes) {
  TriangleSoup soup = boxSurface({1, 1, 1});
  const Triangle t = soup.triangles[3];
  soup.triangles.push_back({t[0], t[0], t[1]});
  soup.triangles.push_back({t[1], t[2], t[0]});
  const ClosedSurface surface = closed(soup);
  EXPECT_EQ(surface.triangles.size(), soup.triangles.size() - 2);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("left out: 1 triangle without area")));
  EXPECT_THAT(surface.notes, Contains(HasSubstr("1 repeated triangle")));
}

TEST(ClosedSurface, TurnsASurfaceThatFacesInward) {
  const ClosedSurface surface = closed(insideOut(sphereSurface(2)));
  EXPECT_GT(surface.volume, 0);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("faced inward")));
  EXPECT_NEAR(closed(sphereSurface(2)).volume, surface.volume, 1e-12);
}

TEST(ClosedSurface, TurnsSingleTrianglesLikeTheirNeighbours) {
  TriangleSoup soup = sphereSurface(1);
  for (const std::size_t t : {0, 7, 8}) std::swap(soup.triangles[t][0], soup.triangles[t][1]);
  const ClosedSurface surface = closed(soup);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("3 of 432 triangles")));
  EXPECT_NEAR(surface.volume, closed(sphereSurface(1)).volume, 1e-12);
}

TEST(ClosedSurface, AShellInAShellIsABodyWithACavity) {
  for (const TriangleSoup& inner : {sphereSurface(0.4), insideOut(sphereSurface(0.4))}) {
    const ClosedSurface surface = closed(together(sphereSurface(1), inner));
    const double outer_volume = closed(sphereSurface(1)).volume,
                 inner_volume = closed(sphereSurface(0.4)).volume;
    EXPECT_NEAR(surface.volume, outer_volume - inner_volume, 1e-12);
    ASSERT_EQ(surface.cavities.size(), 1u);
    EXPECT_LT(surface.cavities[0].norm(), 0.39) << "a point in the cavity";
    EXPECT_THAT(surface.notes, Contains(HasSubstr("cavities")));
  }
}

TEST(ClosedSurface, RefusesAnOpenSurfaceWithNumberAndPlaceOfEdges) {
  TriangleSoup soup = sphereSurface(1);
  soup.triangles.pop_back();
  refuses(soup,
          {"organ.stl: the surface is open", "3 of its edges", "the first at (", "Close Holes"});
  soup.triangles = {soup.triangles[0]};
  refuses(soup, {"is open", "3 of its edges"});
}

TEST(ClosedSurface, ClosesGapsOfSomeHundredThousandthsOfTheBody) {
  const ClosedSurface surface = closed(tornSphere(1e-4));
  EXPECT_EQ(surface.points.size(), sphereSurface(1).points.size());
  EXPECT_EQ(surface.triangles.size(), sphereSurface(1).triangles.size());
  EXPECT_NEAR(surface.volume, closed(sphereSurface(1)).volume, 1e-3);
  EXPECT_THAT(surface.notes, Contains(HasSubstr("gaps were closed")));
}

TEST(ClosedSurface, DistinguishesHolesFromGapsTooWideToClose) {
  refuses(tornSphere(0.01), {"is open", "up to 0.0", "Merge Close Vertices"});
  TriangleSoup with_hole = tornSphere(0.01);
  with_hole.triangles.pop_back();
  refuses(with_hole, {"Merge Close Vertices", "remaining holes (3 open edges)"});
  TriangleSoup with_narrow_gaps = tornSphere(1e-4);
  with_narrow_gaps.triangles.pop_back();
  refuses(with_narrow_gaps, {"3 of its edges", "Close Holes"});
}

TEST(ClosedSurface, FillsCavitiesNarrowerThanAnEdgeOfTheElements) {
  TriangleSoup soup = together(sphereSurface(50, 8), sphereSurface(20, 6, {10, 0, 0}));
  for (const double x : {-40., -35., -30., -25.})
    soup = together(soup, insideOut(sphereSurface(0.5, 1, {x, 3, 0})));
  const ClosedSurface coarse = closed(soup);
  EXPECT_EQ(coarse.cavities.size(), 1u) << "a cavity of width 40 is not narrow";
  EXPECT_EQ(coarse.triangles.size(),
            sphereSurface(50, 8).triangles.size() + sphereSurface(20, 6).triangles.size());
  EXPECT_THAT(coarse.notes, Contains(HasSubstr("4 cavities narrower than")));
  const ClosedSurface fine = closedSurface(soup, "organ.stl", Bodies::only, {.size = 0.5});
  EXPECT_EQ(fine.cavities.size(), 5u);
  EXPECT_LT(fine.volume, coarse.volume);
}

TEST(ClosedSurface, RefusesInnerWalls) {
  TriangleSoup soup = boxSurface({1, 1, 1}, 1);
  const Triangle t = soup.triangles[0];
  soup.points.emplace_back(0, 0, 0);
  const auto middle = static_cast<std::int32_t>(soup.points.size()) - 1;
  // A fin on one edge, closed like an envelope.
  soup.triangles.push_back({t[0], t[1], middle});
  soup.points.emplace_back(0.1, 0, 0);
  soup.triangles.push_back({t[1], t[0], middle + 1});
  soup.triangles.push_back({t[0], middle, middle + 1});
  soup.triangles.push_back({middle, t[1], middle + 1});
  refuses(soup, {"1 of its edges have more than two triangles", "the first at"});
}

TEST(ClosedSurface, RefusesASelfIntersectingSurface) {
  // Two boxes as one shell: they are not connected, so one lies half in the other.
  const TriangleSoup soup =
      together(boxSurface({1, 1, 1}), boxSurface({1, 1, 1}, 2, {0.3, 0.3, 0.3}));
  expectBadInput([&] { closed(soup, Bodies::only); }, {"organ.stl", "2 separate bodies"});
  // A sphere with one corner pulled through the opposite side.
  TriangleSoup drawn = sphereSurface(1);
  drawn.points[0] = -1.5 * drawn.points[0];
  refuses(drawn, {"the surface intersects itself", "pairs of its triangles", "the first at ("});
}

TEST(ClosedSurface, RefusesSeveralBodiesOrTakesTheLargestOnRequest) {
  const TriangleSoup soup = together(boxSurface({1, 1, 1}, 2, {5, 0, 0}), boxSurface({2, 3, 4}));
  refuses(soup, {"organ.stl: there are 2 separate bodies", "2 x 3 x 4 at (0, 0, 0)",
                 "1 x 1 x 1 at (5, 0, 0)", "--largest"});
  const ClosedSurface surface = closed(soup, Bodies::largest);
  EXPECT_NEAR(surface.volume, 24, 1e-12);
  EXPECT_EQ(surface.points.size(), boxSurface({2, 3, 4}).points.size());
  EXPECT_THAT(surface.notes, Contains(HasSubstr("the largest of 2 bodies")));
}

TEST(ClosedSurface, RefusesBodiesThatPenetrateEachOther) {
  const TriangleSoup one = spikedOctahedron(0, 0.4, 0.4, 1),
                     other = spikedOctahedron(0.05, 0.2, 0.6, -1);
  EXPECT_EQ(closed(one).triangles.size(), 12u);
  EXPECT_EQ(closed(other).triangles.size(), 12u);
  refuses(together(one, other), {"organ.stl", "2 pieces"});
}

TEST(ClosedSurface, LeavesOutAnOpenScrapBesideTheLargest) {
  TriangleSoup soup = sphereSurface(1);
  TriangleSoup scrap = boxSurface({1, 1, 1}, 1, {4, 0, 0});
  scrap.triangles.pop_back();
  soup = together(soup, scrap);
  refuses(soup, {"is open", "2 separate pieces", "--largest"});
  EXPECT_THAT(closed(soup, Bodies::largest).notes, Contains(HasSubstr("1 open piece")));
}

TEST(ClosedSurface, RefusesASurfaceThatEnclosesNothing) {
  TriangleSoup flat;
  flat.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  flat.triangles = {{0, 1, 2}, {1, 3, 2}, {0, 3, 1}, {0, 2, 3}};
  refuses(flat, {"encloses no volume"});
  refuses({}, {"no triangles"});
  refuses({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}}, {"coincide"});
  refuses({{{0, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}}, {"corner 2", "only 2"});
  refuses({{{0, 0, 0}, {1e300, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}, {"too far away"});
}

TEST(ClosedSurface, RefusesAOneSidedSurface) {
  // A Klein bottle as a square with identified sides; only the connectivity of the triangles
  // matters, not their shape.
  constexpr int n = 5;
  TriangleSoup soup;
  for (int i = 0; i < n * n; ++i)
    soup.points.emplace_back(std::sin(1.0 + 7 * i), std::cos(2.0 + 3 * i), std::sin(5.0 * i));
  const auto at = [](int i, int k) {
    const bool flipped = i / n % 2 == 1;
    const int row = flipped ? (2 * n - k) % n : k % n;
    return static_cast<std::int32_t>((i % n) * n + row);
  };
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      soup.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
      soup.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
    }
  refuses(soup, {"only one side"});
}

}  // namespace
}  // namespace palpate
