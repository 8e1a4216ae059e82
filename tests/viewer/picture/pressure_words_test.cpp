#include "viewer/picture/pressure_words.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace palpate {
namespace {

Scene mixedScene() {
  Scene scene;
  scene.regions[0].material = {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
  scene.storage.displacement = StoredNodes::all;
  return scene;
}

std::string wordsOf(const Scene& scene) { return whyNoPressures(SurfacePressures(scene, 4)); }

bool names(const std::string& text, const std::vector<std::string>& keys) {
  return std::ranges::all_of(keys,
                             [&](const std::string& key) { return text.find(key) != text.npos; });
}

TEST(PressureWords, NameTheKeysThatMakePressuresBeStored) {
  Scene scene = mixedScene();
  scene.storage.displacement = StoredNodes::surface;
  EXPECT_TRUE(names(wordsOf(scene), {"displacement = \"all\"", "[storage]"})) << wordsOf(scene);
  scene.discretization.pressure = PressureSpace::none;
  EXPECT_TRUE(names(wordsOf(scene), {"pressure = \"none\"", "[discretization]",
                                     "displacement = \"all\"", "[storage]"}))
      << wordsOf(scene);
  scene.regions[0].material = {.law = LawName::linear, .young = 1e4, .poisson = 0.4};
  EXPECT_TRUE(names(wordsOf(scene), {"linear"})) << wordsOf(scene);
  EXPECT_FALSE(names(wordsOf(scene), {"[storage]"})) << "storing more would not help";
}

TEST(PressureWords, SayHowFarThePreparationIs) {
  EXPECT_TRUE(names(wordsOf(mixedScene()), {"preparing", "0 %"})) << wordsOf(mixedScene());
}

}  // namespace
}  // namespace palpate
