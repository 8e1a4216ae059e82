#include "viewer/haptics/surface_pressures.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/meshes.hpp"
#include "tests/support/pressed_body.hpp"
#include "tests/support/temporary_directory.hpp"
#include "viewer/haptics/haptic_model.hpp"

namespace palpate {
namespace {

constexpr std::int32_t middle_of_top = 112;

class SurfacePressuresTest : public testing::Test {
 protected:
  Dataset sealed(const test::PressedBody& body) const {
    body.seal(directory / "body.h5");
    return Dataset(directory / "body.h5");
  }
  static std::vector<float> pressuresOf(const HapticModel& model, const SpaceBlend& blend,
                                        const Eigen::Vector3d& p) {
    std::vector<float> out(model.surface().vertices().size(), 7.0F);
    model.pressures().evaluate(blend, p, out);
    return out;
  }
  static SpaceBlend blendOf(const std::vector<SpaceWeight>& shares) {
    SpaceBlend blend;
    std::ranges::copy(shares, blend.shares.begin());
    blend.size = static_cast<std::int32_t>(shares.size());
    return blend;
  }

  test::TemporaryDirectory directory;
  Mesh mesh = test::cubeMesh(0.1, 4);
  const HapticModelOptions asked{.methods = {"trilinear"}, .pressures = true};
};

TEST_F(SurfacePressuresTest, BlendTheSpacesOfATouchAtEachVertex) {
  const test::PressedBody body(mesh, {{middle_of_top}, {middle_of_top + 1}});
  const Dataset dataset = sealed(body);
  const HapticModel model(dataset, asked);
  ASSERT_TRUE(model.pressures().isPrepared());
  const Eigen::Vector3d p(0, 0.015, -0.015);  // a lattice point
  const std::vector<float> found = pressuresOf(model, blendOf({{0, 0.25}, {1, 0.75}}), p);
  for (std::size_t v = 0; v < found.size(); ++v) {
    const std::int32_t node = dataset.surfaceNodes()[v];
    EXPECT_NEAR(found[v], 0.25F * body.pressure(0, p, node) + 0.75F * body.pressure(1, p, node),
                1e-3);
  }
}

TEST_F(SurfacePressuresTest, ArePositiveInCompressionAsStored) {
  const test::PressedBody body(mesh, {{middle_of_top}});
  const Dataset dataset = sealed(body);
  const HapticModel model(dataset, asked);
  const std::int32_t under = model.surface().activeVertex(0);
  ASSERT_GE(under, 0);
  for (const double depth : {-0.015, 0.015}) {
    const float found =
        pressuresOf(model, blendOf({{0, 1}}), {0, 0, -depth})[static_cast<std::size_t>(under)];
    EXPECT_FLOAT_EQ(found, body.pressure(0, {0, 0, -depth}, middle_of_top));
    EXPECT_EQ(found > 0, depth > 0);
  }
}

TEST_F(SurfacePressuresTest, EqualTheRestStatesWithoutATouch) {
  const HapticModel model(sealed(test::PressedBody(mesh, {{middle_of_top}})), asked);
  for (const float pressure : pressuresOf(model, {}, {0, 0, -0.02}))
    EXPECT_EQ(pressure, test::PressedBody::at_rest);
}

TEST_F(SurfacePressuresTest, AreMissingWithoutAMaterialThatHasThem) {
  const test::PressedBody layered(mesh, {{middle_of_top}}, 1, 0.04);
  const HapticModel model(sealed(layered), asked);
  EXPECT_FALSE(model.pressures().everywhere());
  const std::vector<float> found = pressuresOf(model, blendOf({{0, 1}}), {0, 0, -0.01});
  for (std::size_t v = 0; v < found.size(); ++v)
    EXPECT_EQ(std::isnan(found[v]), model.surface().vertices()[v].z() < 0.04) << v;
  EXPECT_TRUE(HapticModel(sealed(test::PressedBody(mesh, {{middle_of_top}})), asked)
                  .pressures()
                  .everywhere());
}

/// Zero is an ordinary pressure where all materials have one.
TEST_F(SurfacePressuresTest, AreZeroAndNotMissingInABodyOfOneMaterial) {
  test::TouchableBody still(mesh, {{middle_of_top}});
  still.problem.scene.storage.displacement = StoredNodes::all;
  still.seal(directory / "still.h5");
  const HapticModel model(Dataset(directory / "still.h5"), asked);
  EXPECT_EQ(model.pressures().usual(), 0);
  for (const float pressure : pressuresOf(model, blendOf({{0, 1}}), {0, 0, -0.01}))
    EXPECT_EQ(pressure, 0);
}

/// The median is over vertices that have a pressure.
TEST_F(SurfacePressuresTest, HaveTheMedianStrengthAsTheirUsualOne) {
  for (const double linear_below : {-1.0, 0.07}) {
    const test::PressedBody body(mesh, {{middle_of_top}}, 1, linear_below);
    const Dataset dataset = sealed(body);
    const double usual = HapticModel(dataset, asked).pressures().usual();
    int weaker = 0, stronger = 0;
    for (std::int32_t n = 0; n < body.spaces[0].lattice.size(); ++n) {
      std::vector<float> pressures;
      for (const std::int32_t node : dataset.surfaceNodes())
        if (mesh.nodes[static_cast<std::size_t>(node)].z() >= linear_below)
          pressures.push_back(body.pressure(0, body.spaces[0].lattice.displacement(n), node));
      const double strength = strengthOf(pressures);
      weaker += strength < usual;
      stronger += strength > usual;
    }
    EXPECT_GT(usual, test::PressedBody::at_rest);
    EXPECT_LE(weaker, body.spaces[0].lattice.size() / 2);
    EXPECT_LE(stronger, body.spaces[0].lattice.size() / 2);
    EXPECT_GT(stronger, 0);
  }
}

TEST(Strength, IsThe95thPercentileOfTheAbsoluteValue) {
  std::vector<float> pressures(100, -10.0F);
  std::fill_n(pressures.begin(), 4, 9000.0F);
  EXPECT_EQ(strengthOf(pressures), 10) << "four of a hundred are outliers";
  std::fill_n(pressures.begin(), 6, -500.0F);
  EXPECT_EQ(strengthOf(pressures), 500);
  pressures.assign(50, std::nanf(""));
  EXPECT_EQ(strengthOf(pressures), 0);
  pressures.push_back(-3);
  EXPECT_EQ(strengthOf(pressures), 3) << "of the vertices that have a pressure";
}

TEST_F(SurfacePressuresTest, PreparationResumesWhereItWasStopped) {
  HapticModelOptions later = asked;
  later.prepare = false;
  const test::PressedBody body(mesh, {{middle_of_top}, {middle_of_top + 1}});
  HapticModel model(sealed(body), later);
  EXPECT_FALSE(model.pressures().isPrepared());
  EXPECT_EQ(model.pressures().preparedShare(), 0);
  std::stop_source stopped;
  stopped.request_stop();
  model.preparePressures(stopped.get_token());
  EXPECT_FALSE(model.pressures().isPrepared());
  model.preparePressures();
  ASSERT_TRUE(model.pressures().isPrepared());
  EXPECT_EQ(model.pressures().preparedShare(), 1);
  const std::vector<float> once = pressuresOf(model, blendOf({{1, 1}}), {0, 0, -0.01});
  model.preparePressures();
  EXPECT_EQ(pressuresOf(model, blendOf({{1, 1}}), {0, 0, -0.01}), once) << "nothing is left to do";
}

TEST_F(SurfacePressuresTest, AreNeverPreparedUnlessRequested) {
  HapticModel model(sealed(test::PressedBody(mesh, {{middle_of_top}})), {});
  model.preparePressures();
  EXPECT_FALSE(model.pressures().isPrepared());
  EXPECT_EQ(model.pressures().source(), PressureSource::stored);
}

TEST_F(SurfacePressuresTest, NameTheSceneSettingThatPreventsThem) {
  Scene scene;
  scene.regions[0].material = {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
  EXPECT_EQ(pressureSourceOf(scene), PressureSource::storage);
  scene.storage.displacement = StoredNodes::all;
  EXPECT_EQ(pressureSourceOf(scene), PressureSource::stored);
  scene.discretization.pressure = PressureSpace::none;
  EXPECT_EQ(pressureSourceOf(scene), PressureSource::formulation);
  scene.regions[0].material = {.law = LawName::linear, .young = 1e4, .poisson = 0.4};
  EXPECT_EQ(pressureSourceOf(scene), PressureSource::material);
}

TEST_F(SurfacePressuresTest, AreNeverPreparedForADatasetWithoutThem) {
  test::TouchableBody(mesh, {{middle_of_top}}).seal(directory / "without.h5");
  HapticModel model(Dataset(directory / "without.h5"), asked);
  model.preparePressures();
  EXPECT_FALSE(model.pressures().isPrepared());
  EXPECT_EQ(model.pressures().source(), PressureSource::storage);
}

}  // namespace
}  // namespace palpate
