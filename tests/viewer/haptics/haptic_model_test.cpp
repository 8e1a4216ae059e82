#include "viewer/haptics/haptic_model.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

TEST(HapticModel, OutlivesTheDatasetAndItsFile) {
  const Mesh mesh = test::cubeMesh(0.1, 4);
  test::TouchableBody body(mesh, {{112}, {113, 2}});
  body.problem.scene.contact = ContactMode::glued;
  const HapticModel model = test::modelOf(body);
  EXPECT_EQ(model.name(), "touchable");
  EXPECT_NE(model.file().find("body.h5"), std::string::npos);
  EXPECT_EQ(model.contactMode(), ContactMode::glued);
  EXPECT_EQ(model.maxForce(), 8.5);
  EXPECT_EQ(model.methods(), (std::vector<std::string>{"potential", "trilinear"}));
  ASSERT_EQ(model.spaces().size(), 2u);
  for (std::size_t method = 0; method < 2; ++method) {
    EXPECT_EQ(model.field(method, 1).name(), model.methods()[method]);
    const Eigen::Vector3d p(0.015, 0, 0);  // a lattice point
    EXPECT_LT((model.field(method, 1).evaluate(p).force + test::ConvexEnergy(2).gradient(p)).norm(),
              1e-6);
  }
}

TEST(HapticModel, PreparesAMethodWhileAnotherIsRead) {
  const test::TemporaryDirectory directory;
  test::TouchableBody(test::cubeMesh(0.1, 4), {{112}, {113, 2}}).seal(directory / "body.h5");
  const Dataset dataset(directory / "body.h5");
  HapticModel model(dataset, {.methods = {"trilinear", "potential"}, .prepare = false});
  EXPECT_FALSE(model.isPrepared(0));
  EXPECT_EQ(model.preparedShare(0), 0);
  model.prepare(0);
  ASSERT_TRUE(model.isPrepared(0));
  EXPECT_FALSE(model.isPrepared(1));

  const std::jthread background(
      [&](const std::stop_token& stop) { model.prepare(1, stop, /*alone=*/true); });
  const Eigen::Vector3d p(0.004, 0.002, -0.003);
  const Eigen::Vector3d before = model.field(0, 1).evaluate(p).force;
  while (!model.isPrepared(1)) EXPECT_EQ(model.field(0, 1).evaluate(p).force, before);
  EXPECT_EQ(model.preparedShare(1), 1);
  EXPECT_EQ(model.field(1, 1).evaluate(p).force,
            HapticModel(dataset).field(0, 1).evaluate(p).force);
}

TEST(HapticModel, ResumesAStoppedPreparation) {
  const test::TemporaryDirectory directory;
  test::TouchableBody(test::cubeMesh(0.1, 4), {{112}, {113, 2}}).seal(directory / "body.h5");
  HapticModel model(Dataset(directory / "body.h5"), {.prepare = false});
  std::stop_source stopped;
  stopped.request_stop();
  model.prepare(0, stopped.get_token());
  EXPECT_EQ(model.preparedShare(0), 0);
  model.prepare(0, std::stop_token());
  EXPECT_TRUE(model.isPrepared(0));
}

TEST(HapticModel, RestartsAStoppedAreaPreparation) {
  const test::TemporaryDirectory directory;
  test::FingerBody().seal(directory / "body.h5");
  HapticModel model(Dataset(directory / "body.h5"), {.prepare = false});
  std::stop_source stopped;
  stopped.request_stop();
  model.prepare(0, stopped.get_token());
  EXPECT_EQ(model.preparedShare(0), 0);
  model.prepare(0, std::stop_token(), /*alone=*/true);
  EXPECT_TRUE(model.isPrepared(0));
  EXPECT_EQ(model.preparedShare(0), 1);
}

TEST(HapticModel, RefusesUnknownMethodsAndAnEmptyList) {
  const test::TouchableBody body(test::cubeMesh(0.1, 4), {{112}});
  const test::TemporaryDirectory directory;
  body.seal(directory / "body.h5");
  const Dataset dataset(directory / "body.h5");
  test::expectBadInput([&] { HapticModel(dataset, {.methods = {"quadlinear"}}); }, {"quadlinear"});
  test::expectBadInput([&] { HapticModel(dataset, {.methods = {}}); }, {"body.h5", "method"});
}

}  // namespace
}  // namespace palpate
