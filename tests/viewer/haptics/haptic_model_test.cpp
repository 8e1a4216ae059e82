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

/// The body of a finger, whole, and while its build has not begun with the first site.
class GrowingBody : public testing::Test {
 protected:
  static constexpr std::size_t unfinished = 0;
  static void SetUpTestSuite() {
    const test::TemporaryDirectory directory;
    test::FingerBody body;
    place = body.spaces[unfinished].patch.finger->center;
    body.seal(directory / "whole.h5");
    for (PointRecord& point : body.spaces[unfinished].points) point = {};
    body.seal(directory / "part.h5");
    const auto modelOf = [&](const char* file, bool guess) {
      return std::make_unique<HapticModel>(
          Dataset(directory / file), HapticModelOptions{.methods = {"potential"}, .guess = guess});
    };
    whole = modelOf("whole.h5", true);
    part = modelOf("part.h5", false);
    guessed = modelOf("part.h5", true);
    ASSERT_GT((place - elsewhere).norm(), 0.03);
  }
  static void TearDownTestSuite() {
    for (auto* model : {&whole, &part, &guessed}) model->reset();
  }

  static inline std::unique_ptr<HapticModel> whole, part, guessed;
  static inline Eigen::Vector3d place;  ///< of the unfinished site
  static inline const Eigen::Vector3d elsewhere{0.05, 0.05, 0.1};
  static inline const Eigen::Vector3d push{0, 0, -0.004};
};

TEST_F(GrowingBody, IsTouchableWhereASiteIsSolved) {
  EXPECT_EQ(part->surface().areas()[0].spaces.size(), part->spaces().size() - 1);
  EXPECT_FALSE(part->isGuessAt(place));
  const Eigen::Vector3d force = whole->area(0).evaluate(elsewhere, push).force;
  EXPECT_LT((part->area(0).evaluate(elsewhere, push).force - force).norm(), 0.1 * force.norm());
  std::vector<float> shape(3 * part->surface().vertices().size(), 1);
  part->shape(unfinished).evaluate(push, shape);
  EXPECT_EQ(shape.front(), 0) << "a site without a solved point is shown at rest";
}

TEST_F(GrowingBody, IsAGuessOnlyNearUnfinishedSites) {
  EXPECT_TRUE(guessed->isGuess(unfinished));
  EXPECT_TRUE(guessed->isGuessAt(place));
  EXPECT_GT(guessed->area(0).evaluate(place, push).force.z(), 0.1);
  EXPECT_FALSE(guessed->isGuessAt(elsewhere));
  EXPECT_FALSE(whole->isGuessAt(place));
  // From the unfinished site to the other corner of the area.
  for (double share = 0; share <= 1; share += 0.02) {
    const Eigen::Vector3d on_the_way = place + share * 2 * (elsewhere - place);
    EXPECT_EQ(guessed->area(0).evaluate(on_the_way, push).force !=
                  whole->area(0).evaluate(on_the_way, push).force,
              guessed->isGuessAt(on_the_way))
        << share;
  }
}

/// The bound of a guess is at least the force, and results replace a guess without a kick.
TEST_F(GrowingBody, ReplacesAGuessUnderTheHand) {
  Contact contact(*guessed);
  contact.update(place + Eigen::Vector3d(0, 0, 0.001));
  Touch touch = contact.update(place + push);
  ASSERT_TRUE(touch.touching);
  EXPECT_FALSE(touch.inside);
  EXPECT_GE(touch.error_bound, touch.force.norm());
  contact.replace(*guessed, *whole);
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
