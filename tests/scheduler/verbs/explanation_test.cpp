#include "scheduler/verbs/explanation.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scheduler/service/status.hpp"
#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

/// A space of 7 points, the origin and its axis neighbours: number 1 is solved, number 2 failed,
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
  EXPECT_THAT(explained(3).text(), testing::HasSubstr("no solve of this point has been tried yet"));
}

TEST_F(ExplanationTest, SaysThatAPointLiesBehindUnexpandablePoints) {
  space.points[3].tag = Tag::failed;
  space.points[3].cause = Cause::unreachable;
  const wire::Explanation explanation = explained(3);
  EXPECT_EQ(explanation.cause(), "unreachable");
  EXPECT_THAT(explanation.text(), testing::AllOf(testing::HasSubstr("failed, unreachable"),
                                                 testing::HasSubstr("every neighbour failed")));
}

TEST_F(ExplanationTest, EndsOnACycleOfParents) {
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

/// The spaces of active nodes with these names and areas; those with an area are finger sites of
/// it.
KnownSpaces spacesOf(const std::vector<std::pair<const char*, const char*>>& names_and_areas) {
  KnownSpaces known;
  for (const auto& [name, area] : names_and_areas) {
    ActiveSelection& active = known.scene.active.emplace_back();
    active.name = name;
    active.area = area;
    SpaceTable& space = known.spaces.emplace_back();
    space.patch.name = name;
    if (active.area.empty()) continue;
    active.tool = ToolKind::finger;
    space.patch.finger = Finger{{0.01 * static_cast<double>(known.spaces.size()), 0, 0}, 0.02};
  }
  return known;
}

TEST_F(ExplanationTest, TheOnlyActiveNodeNeedsNoName) {
  const KnownSpaces one = spacesOf({{"tip", ""}}), two = spacesOf({{"tip", ""}, {"corner", ""}});
  EXPECT_EQ(&one.named(""), &one.spaces[0]);
  EXPECT_EQ(&two.named("corner"), &two.spaces[1]);
  test::expectBadInput([&] { two.named(""); }, {"--active", "tip, corner"});
  test::expectBadInput([&] { two.named("toe"); }, {"toe", "tip, corner"});
}

TEST_F(ExplanationTest, APlaceOnASurfaceMeansItsNearestSite) {
  KnownSpaces known =
      spacesOf({{"tip", ""}, {"skin-1", "skin"}, {"skin-2", "skin"}, {"skin-left-1", "skin-left"}});
  EXPECT_EQ(&known.named("skin", Eigen::Vector3d(0.021, 0.001, 0)), &known.spaces[1]);
  EXPECT_EQ(&known.named("skin", Eigen::Vector3d(1, 0, 0)), &known.spaces[2]);
  EXPECT_EQ(&known.named("skin-left", Eigen::Vector3d(0, 0, 0)), &known.spaces[3]);
  EXPECT_EQ(&known.named("skin-2"), &known.spaces[2]);
  EXPECT_EQ(&known.named("skin-1", Eigen::Vector3d(1, 0, 0)), &known.spaces[1]);
  test::expectBadInput([&] { known.named("skin"); }, {"skin", "--at X Y Z"});
  test::expectBadInput([&] { known.named("skin", Eigen::Vector3d(NAN, 0, 0)); },
                       {"--at", "finite"});
  test::expectBadInput([&] { known.named("tip", Eigen::Vector3d(1, 0, 0)); },
                       {"--at", "\"tip\" is not a finger"});
}

/// Events name it like any other space.
TEST_F(ExplanationTest, AProbePlaceOfAnAreaHasAName) {
  KnownSpaces known = spacesOf({{"skin-1", "skin"}, {"skin-probe-1", ""}});
  known.scene.active[1].probe = Eigen::Vector3d(0, 0, 0.01);
  known.scene.active[1].probe_of = "skin";
  EXPECT_EQ(&known.named("skin-probe-1"), &known.spaces[1]);
  EXPECT_EQ(&known.named("", Eigen::Vector3d(1, 0, 0)), &known.spaces[0]);
}

}  // namespace
}  // namespace palpate
