#include "common/scene/active_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/expect_error.hpp"

namespace palpate {
namespace {

using ::testing::ElementsAre;

/// A node between two sites of an area.
Scene sceneOfNodesAndSites() {
  Scene scene;
  scene.active = {{.name = "skin-0", .tool = ToolKind::finger, .area = "skin"},
                  {.name = "tip"},
                  {.name = "skin-1", .tool = ToolKind::finger, .area = "skin"}};
  return scene;
}

TEST(ActiveChoiceTest, SelectsANodeASiteOrAllSitesOfAnArea) {
  const Scene scene = sceneOfNodesAndSites();
  EXPECT_THAT(chooseActive(scene, "tip").spaces, ElementsAre(1));
  EXPECT_THAT(chooseActive(scene, "skin-1").spaces, ElementsAre(2));
  EXPECT_FALSE(chooseActive(scene, "skin-1").is_area);
  const ActiveChoice area = chooseActive(scene, "skin");
  EXPECT_THAT(area.spaces, ElementsAre(0, 2));
  EXPECT_TRUE(area.is_area);
}

TEST(ActiveChoiceTest, KnowsTheAreasOfAScene) {
  const std::vector<ActiveChoice> areas = areasOf(sceneOfNodesAndSites());
  ASSERT_EQ(areas.size(), 1u);
  EXPECT_EQ(areas[0].name, "skin");
  EXPECT_THAT(areas[0].spaces, ElementsAre(0, 2));
  EXPECT_TRUE(areasOf(Scene()).empty());
}

TEST(ActiveChoiceTest, ExcludesProbePlacesOfAnArea) {
  Scene scene = sceneOfNodesAndSites();
  for (const char* name : {"skin-probe-0", "skin-probe-1"})
    scene.active.push_back({.name = name,
                            .tool = ToolKind::finger,
                            .probe_of = "skin",
                            .probe = Eigen::Vector3d(0, 0, 0.01)});
  test::expectBadInput([&] { chooseActive(scene, "skin-probe-0"); }, {"skin, tip"});
  EXPECT_THAT(chooseActive(scene, "skin").spaces, ElementsAre(0, 2));
  EXPECT_THAT(areasOf(scene).at(0).probe_places, ElementsAre(0, 1));
}

TEST(ActiveChoiceTest, NeedsNoNameIfThereIsOnlyOne) {
  Scene scene = sceneOfNodesAndSites();
  scene.active.erase(scene.active.begin() + 1);
  EXPECT_EQ(chooseActive(scene, "").name, "skin");
  scene.active = {{.name = "tip"}};
  EXPECT_THAT(chooseActive(scene, "").spaces, ElementsAre(0));
}

TEST(ActiveChoiceTest, ListsTheValidNames) {
  const Scene scene = sceneOfNodesAndSites();
  test::expectBadInput([&] { chooseActive(scene, ""); }, {"--active", "skin, tip"});
  test::expectBadInput([&] { chooseActive(scene, "toe"); }, {"\"toe\"", "skin, tip"});
}

TEST(ActiveChoiceTest, AnAreaNeedsAPlace) {
  const Scene scene = sceneOfNodesAndSites();
  test::expectBadInput([&] { requirePlace(chooseActive(scene, "skin"), false); },
                       {"\"skin\"", "--at X Y Z"});
  EXPECT_NO_THROW(requirePlace(chooseActive(scene, "skin"), true));
  EXPECT_NO_THROW(requirePlace(chooseActive(scene, "tip"), false));
  test::expectBadInput([&] { requirePlace(chooseActive(scene, "tip"), true); },
                       {"--at", "\"tip\" is not a finger", "omit --at"});
}

}  // namespace
}  // namespace palpate
