#include "scheduler/verbs/explanation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/service/status.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

/// A space of 7 points: the origin and its axis neighbours. Number 1 was reached, number 2 failed,
/// the rest is unknown.
struct ExplanationTest : testing::Test {
  const Lattice lattice{0.01, 0.01};
  SpaceTable space;

  ExplanationTest() {
    space.patch.name = "tip";
    space.lattice = lattice;
    space.points.resize(7);
    for (const std::int32_t n : {0, 1}) {
      space.points[n].tag = Tag::expandable;
      space.points[n].parent = 0;
    }
    space.points[1].equilibrium.force = {-1.5, 0, 0};
    space.points[2].tag = Tag::failed;
    space.points[2].cause = Cause::wrong_inertia;
    Failure f;
    f.cause = Cause::wrong_inertia;
    f.step_reached = 0.25;
    space.attempts = {{2, 0, f}};
  }

  wire::Explanation explained(std::int32_t point) const {
    return explain(space, Eigen::Vector3d(lattice.displacement(point) / lattice.spacing()));
  }
};

TEST_F(ExplanationTest, FollowsTheParentsBackToTheOrigin) {
  const wire::Explanation explanation = explained(1);
  ASSERT_EQ(explanation.path_size(), 2);
  EXPECT_EQ(explanation.path(0).force(0), -1.5);
  EXPECT_EQ(explanation.path(1).point().i(), 0);
  EXPECT_THAT(explanation.text(),
              testing::AllOf(testing::HasSubstr("expandable"), testing::HasSubstr("-1.5")));
}

TEST_F(ExplanationTest, NamesEveryAttemptOfAFailedPoint) {
  const wire::Explanation explanation = explained(2);
  EXPECT_EQ(explanation.path_size(), 0);
  EXPECT_EQ(explanation.cause(), "wrong_inertia");
  ASSERT_EQ(explanation.attempts_size(), 1);
  EXPECT_THAT(explanation.text(), testing::HasSubstr("from (0, 0, 0): wrong_inertia at 25.0 %"));
  EXPECT_THAT(toJson(explanation), testing::HasSubstr("\"step_reached\":0.25"));
}

TEST_F(ExplanationTest, SaysThatAPointWasNotTriedYet) {
  EXPECT_THAT(explained(3).text(), testing::HasSubstr("no transition to it was tried yet"));
}

TEST_F(ExplanationTest, SaysThatAPointLiesBehindOthersThatCannotBeExpanded) {
  space.points[3].tag = Tag::failed;
  space.points[3].cause = Cause::unreachable;
  const wire::Explanation explanation = explained(3);
  EXPECT_EQ(explanation.cause(), "unreachable");
  EXPECT_THAT(explanation.text(),
              testing::AllOf(testing::HasSubstr("failed, unreachable"),
                             testing::HasSubstr("no neighbour can be expanded")));
}

TEST_F(ExplanationTest, EndsOnACircleOfParents) {
  space.points[1].parent = 3;
  space.points[3].parent = 1;
  EXPECT_LE(explained(1).path_size(), 7);
}

TEST_F(ExplanationTest, NamesTheBoundsOfTheLattice) {
  test::expectBadInput(
      [&] {
        explain(space, {1, 1, 0});
      },
      {"(1, 1, 0)", "not in the lattice", "<= 1"});
}

TEST_F(ExplanationTest, TheOnlyActiveNodeNeedsNoName) {
  std::vector<SpaceTable> spaces = {space};
  EXPECT_EQ(&spaceNamed(spaces, ""), &spaces[0]);
  spaces.push_back(space);
  spaces[1].patch.name = "corner";
  EXPECT_EQ(&spaceNamed(spaces, "corner"), &spaces[1]);
  test::expectBadInput([&] { spaceNamed(spaces, ""); }, {"--active", "tip, corner"});
  test::expectBadInput([&] { spaceNamed(spaces, "toe"); }, {"toe", "tip, corner"});
}

TEST_F(ExplanationTest, OfASurfaceTheSiteNearestToAPlaceIsMeant) {
  std::vector<SpaceTable> spaces(20, space);
  for (std::size_t n = 1; n < spaces.size(); ++n) {
    spaces[n].patch.name = fmt::format("skin-{}", n);
    spaces[n].patch.finger = Finger{{0.01 * static_cast<double>(n), 0, 0}, 0.02};
  }
  spaces[19].patch.name = "skin-left-1";
  EXPECT_EQ(&siteNearest(spaces, "skin", {0.031, 0.001, 0}), &spaces[3]);
  EXPECT_EQ(&siteNearest(spaces, "skin", {1, 0, 0}), &spaces[18]);
  EXPECT_EQ(&siteNearest(spaces, "", {1, 0, 0}), &spaces[19]);
  EXPECT_EQ(&siteNearest(spaces, "skin-7", {1, 0, 0}), &spaces[7]);
  EXPECT_EQ(&siteNearest(spaces, "skin-left", {0, 0, 0}), &spaces[19]);
  spaces[3].patch.probe = Eigen::Vector3d(0, 0, 0.01);  // a place where the area is measured
  EXPECT_EQ(&siteNearest(spaces, "", {0.031, 0.001, 0}), &spaces[4]);
  test::expectBadInput([&] { siteNearest(spaces, "skin", {NAN, 0, 0}); }, {"--at", "finite"});
  test::expectBadInput(
      [&] {
        siteNearest(spaces, "tip", {1, 0, 0});
      },
      {"--at", "tip is no finger"});
  test::expectBadInput([&] { spaceNamed(spaces, "skin"); }, {"skin-1, skin-2", "(20 in all)"});
}

}  // namespace
}  // namespace palpate
