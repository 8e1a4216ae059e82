#include "viewer/haptics/haptic_model.hpp"

#include <gtest/gtest.h>

#include <thread>

#include "tests/support/expect_error.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/viewer/haptics/touched_model.hpp"
#include "viewer/haptics/contact.hpp"

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

/// The body of a finger whose build has not begun with the site nearest to a corner of the top.
class GrowingBody : public testing::Test {
 protected:
  static constexpr std::size_t unfinished = 0;
  GrowingBody() {
    const Eigen::Vector3d far = body.spaces[unfinished].patch.finger->center;
    body.seal(directory / "whole.h5");
    for (PointRecord& point : body.spaces[unfinished].points) point = {};
    body.seal(directory / "part.h5");
    EXPECT_GT((far - elsewhere).norm(), 0.03);
  }
  Eigen::Vector3d unfinishedPlace() const { return body.spaces[unfinished].patch.finger->center; }
  HapticModel modelOf(const char* file, bool guess) const {
    return HapticModel(Dataset(directory / file), {.methods = {"potential"}, .guess = guess});
  }

  const test::TemporaryDirectory directory;
  test::FingerBody body;
  const Eigen::Vector3d elsewhere{0.05, 0.05, 0.1};
  const Eigen::Vector3d push{0, 0, -0.004};
};

TEST_F(GrowingBody, IsTouchableWhereASiteIsSolved) {
  const HapticModel model = modelOf("part.h5", false);
  EXPECT_EQ(model.surface().areas()[0].spaces.size(), body.spaces.size() - 1);
  EXPECT_FALSE(model.isGuessAt(unfinishedPlace()));
  const Eigen::Vector3d whole = modelOf("whole.h5", false).area(0).evaluate(elsewhere, push).force;
  EXPECT_LT((model.area(0).evaluate(elsewhere, push).force - whole).norm(), 0.1 * whole.norm());
  std::vector<float> shape(3 * model.surface().vertices().size(), 1);
  model.shape(unfinished).evaluate(push, shape);
  EXPECT_EQ(shape.front(), 0) << "a site without a solved point is shown at rest";
}

TEST_F(GrowingBody, IsAGuessOnlyNearUnfinishedSites) {
  const HapticModel model = modelOf("part.h5", true), whole = modelOf("whole.h5", true);
  EXPECT_TRUE(model.isGuess(unfinished));
  EXPECT_TRUE(model.isGuessAt(unfinishedPlace()));
  EXPECT_GT(model.area(0).evaluate(unfinishedPlace(), push).force.z(), 0.1);
  EXPECT_FALSE(model.isGuessAt(elsewhere));
  EXPECT_EQ(model.area(0).evaluate(elsewhere, push).force,
            whole.area(0).evaluate(elsewhere, push).force)
      << "an unfinished site has no influence there";
  EXPECT_FALSE(whole.isGuessAt(unfinishedPlace()));
}

/// A single site has no other site from which its error could be estimated.
TEST_F(GrowingBody, BoundsTheGuessOfASingleSite) {
  test::FingerBody single;
  const auto others = [&](auto& list) { list.erase(list.begin() + 1, list.end()); };
  others(single.problem.active);
  others(single.problem.scene.active);
  others(single.spaces);
  for (PointRecord& point : single.spaces[0].points) point = {};
  single.seal(directory / "single.h5");
  const HapticModel model(Dataset(directory / "single.h5"), {.guess = true});
  const Eigen::Vector3d place = single.spaces[0].patch.finger->center;
  Contact contact(model);
  contact.update(place + Eigen::Vector3d(0, 0, 0.001));
  const Touch& touch = contact.update(place + push);
  ASSERT_TRUE(touch.touching);
  EXPECT_GE(touch.error_bound, touch.force.norm());
}

/// The error bound shows that a force is guessed, and a hand feels no kick when results replace the
/// guess.
TEST_F(GrowingBody, ReplacesAGuessUnderTheHand) {
  const HapticModel guess = modelOf("part.h5", true), whole = modelOf("whole.h5", true);
  const Eigen::Vector3d place = unfinishedPlace();
  Contact contact(guess);
  contact.update(place + Eigen::Vector3d(0, 0, 0.001));
  Touch touch = contact.update(place + push);
  ASSERT_TRUE(touch.touching);
  EXPECT_FALSE(touch.inside);
  EXPECT_GE(touch.error_bound, touch.force.norm());
  contact.replace(guess, whole);
  touch = contact.update(place + push);
  EXPECT_TRUE(touch.touching);
  EXPECT_TRUE(touch.stepped) << "the guard turns the step into a ramp";
  EXPECT_TRUE(touch.inside);
  EXPECT_LT(touch.error_bound, touch.force.norm());
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
