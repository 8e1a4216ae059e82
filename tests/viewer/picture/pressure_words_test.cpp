#include "viewer/picture/pressure_words.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace palpate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Scene mixedScene() {
  Scene scene;
  scene.regions[0].material = {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
  scene.storage.displacement = StoredNodes::all;
  return scene;
}

std::string wordsOf(const Scene& scene) { return whyNoPressures(SurfacePressures(scene, 4)); }

TEST(PressureWords, NameTheKeysThatMakePressuresBeStored) {
  Scene scene = mixedScene();
  scene.storage.displacement = StoredNodes::surface;
  EXPECT_THAT(wordsOf(scene), HasSubstr("[storage]"));
  scene.discretization.pressure = PressureSpace::none;
  EXPECT_THAT(wordsOf(scene), AllOf(HasSubstr("[discretization]"), HasSubstr("[storage]")));
  scene.regions[0].material = {.law = LawName::linear, .young = 1e4, .poisson = 0.4};
  EXPECT_THAT(wordsOf(scene), Not(HasSubstr("[storage]"))) << "storing more would not help";
}

}  // namespace
}  // namespace palpate
