#include "viewer/haptics/contact.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "tests/viewer/c_api/sample_file.hpp"
#include "viewer/haptics/deformed_shape.hpp"

namespace palpate {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

constexpr int ticks = 500;

#define EXPECT_INVALID(call, text)             \
  EXPECT_EQ((call), PALPATE_INVALID_ARGUMENT); \
  EXPECT_THAT(palpate_last_error(), HasSubstr(text))

class CContact : public test::SharedSample {
 protected:
  palpate_touch update(palpate_contact* contact, const std::array<double, 3>& tool, int hold = 1) {
    auto touch = test::sized<palpate_touch>();
    EXPECT_EQ(palpate_contact_update(contact, tool.data(), hold, &touch), PALPATE_OK)
        << palpate_last_error();
    return touch;
  }
  /// The state after `ticks` of pressing.
  palpate_touch pressed(palpate_contact* contact, int ticks_done = ticks / 2) {
    palpate_touch touch{};
    for (int n = 0; n <= ticks_done; ++n)
      touch = update(contact, test::pressing(shared(), n, ticks));
    return touch;
  }
};

/// The model's behaviour is tested in tests/viewer/haptics/contact_test.cpp.
TEST_F(CContact, MatchesTheContactModelToTheLastBit) {
  const HapticModel model{Dataset(sharedFile())};
  for (const bool glued : {false, true}) {
    Contact expected(model, {.mode = glued ? ContactMode::glued : ContactMode::unilateral});
    auto options = test::sized<palpate_contact_options>();
    ASSERT_EQ(palpate_contact_defaults(shared(), &options), PALPATE_OK);
    options.mode = glued ? PALPATE_GLUED : PALPATE_UNILATERAL;
    const auto contact = test::touchWith(shared(), &options);
    int touching = 0, steps = 0;
    for (int n = 0; n < 3 * ticks; ++n) {
      auto tool = test::pressing(shared(), n % ticks, ticks);
      if (n == ticks + ticks / 2) tool[0] = test::nan_value;
      if (n == 2 * ticks + ticks / 2) {
        expected.release();
        ASSERT_EQ(palpate_contact_release(contact.get()), PALPATE_OK);
      }
      const bool hold = n % ticks < ticks * 3 / 4;
      const Touch& reference = expected.update({tool[0], tool[1], tool[2]}, hold);
      const palpate_touch touch = update(contact.get(), tool, hold ? 1 : 0);
      ASSERT_EQ(touch.touching, reference.touching ? 1 : 0) << n;
      EXPECT_EQ(touch.stepped, reference.stepped ? 1 : 0);
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(touch.force[i], reference.force[i]) << n;
        EXPECT_EQ(touch.displacement[i], reference.displacement[i]) << n;
        for (int j = 0; j < 3; ++j)
          EXPECT_EQ(touch.stiffness[3 * i + j], reference.stiffness(i, j));
      }
      EXPECT_EQ(touch.triangle, reference.anchor.triangle);
      EXPECT_EQ(touch.share_count, reference.blend.size);
      touching += touch.touching;
      steps += touch.stepped;
    }
    EXPECT_GT(touching, ticks);
    EXPECT_LT(touching, 3 * ticks);
    EXPECT_GE(steps, 2) << "not finite, and a release";
  }
}

TEST_F(CContact, TakesItsDefaultsFromTheScene) {
  auto options = test::sized<palpate_contact_options>();
  ASSERT_EQ(palpate_contact_defaults(shared(), &options), PALPATE_OK);
  EXPECT_EQ(options.mode, PALPATE_UNILATERAL);
  EXPECT_EQ(options.method, 0);
  EXPECT_EQ(options.friction, ContactOptions().friction);
  EXPECT_EQ(options.grab_distance, ContactOptions().grab_distance);
  EXPECT_EQ(options.most_slide, ContactOptions().most_slide);
  EXPECT_EQ(options.most_relaxation, ContactOptions().most_relaxation);

  test::SampleDataset glued;
  glued.problem.scene.contact = ContactMode::glued;
  const test::TemporaryDirectory directory;
  glued.seal(directory / "glued.h5");
  const auto dataset = test::open(directory / "glued.h5");
  ASSERT_EQ(palpate_contact_defaults(dataset.get(), &options), PALPATE_OK);
  EXPECT_EQ(options.mode, PALPATE_GLUED);
}

TEST_F(CContact, OutlivesTheHandleOfItsDataset) {
  auto opened = test::open(sharedFile());
  const auto contact = test::touchWith(opened.get()), other = test::touchWith(shared());
  opened.reset();
  const palpate_touch expected = pressed(other.get());
  ASSERT_EQ(expected.touching, 1);
  EXPECT_TRUE(test::sameBits(pressed(contact.get()), expected));
}

TEST_F(CContact, SwitchesDatasetAndMethodWhileTouching) {
  const auto second = test::open(sharedFile());
  const auto contact = test::touchWith(shared());
  const palpate_touch before = pressed(contact.get());
  ASSERT_EQ(before.touching, 1);
  ASSERT_EQ(palpate_contact_use(contact.get(), second.get(), 1), PALPATE_OK);
  const palpate_touch after = update(contact.get(), test::pressing(shared(), ticks / 2, ticks));
  EXPECT_EQ(after.touching, 1);
  EXPECT_TRUE(std::isnan(after.energy));  // tri-linear forces have no energy
  EXPECT_FALSE(std::isnan(before.energy));
  EXPECT_INVALID(palpate_contact_use(contact.get(), second.get(), 2), "method 2 ");
}

TEST_F(CContact, DeformsTheSurfaceSoThatTheAnchorMeetsTheTool) {
  const auto contact = test::touchWith(shared());
  const palpate_touch touch = pressed(contact.get());
  const HapticModel model{Dataset(sharedFile())};
  std::vector<float> shape(3 * model.surface().vertices().size(), 7), expected(shape.size());
  ASSERT_EQ(palpate_touch_displacements(shared(), &touch, shape.data(), shape.size()), PALPATE_OK)
      << palpate_last_error();

  Contact reference(model);
  for (int n = 0; n <= ticks / 2; ++n) {
    const auto tool = test::pressing(shared(), n, ticks);
    reference.update({tool[0], tool[1], tool[2]});
  }
  DeformedShape(model.surface().vertices().size()).evaluate(model, reference.touch(), expected);
  EXPECT_EQ(shape, expected);

  palpate_touch free = touch;
  free.touching = 0;
  ASSERT_EQ(palpate_touch_displacements(shared(), &free, shape.data(), shape.size()), PALPATE_OK);
  EXPECT_THAT(shape, Each(0.0F));
}

TEST_F(CContact, RefusesInvalidTouches) {
  palpate_touch touch{};
  std::vector<float> shape(3 * static_cast<std::size_t>(test::describe(shared()).vertex_count));
  EXPECT_INVALID(palpate_touch_displacements(shared(), &touch, shape.data(), shape.size()),
                 "touch->size is 0");
  touch.size = sizeof touch;
  touch.touching = 1;
  touch.triangle = 100000;
  EXPECT_INVALID(palpate_touch_displacements(shared(), &touch, shape.data(), shape.size()),
                 "triangle 100000 ");
  touch.triangle = 0;
  touch.share_count = 10;
  EXPECT_INVALID(palpate_touch_displacements(shared(), &touch, shape.data(), shape.size()),
                 "share_count is 10");
  touch.share_count = 1;
  touch.share_spaces[0] = 2;
  EXPECT_INVALID(palpate_touch_displacements(shared(), &touch, shape.data(), shape.size()),
                 "space 2 ");
  touch.share_spaces[0] = 0;
  EXPECT_INVALID(palpate_touch_displacements(shared(), &touch, shape.data(), 3), "holds 3 numbers");
}

TEST_F(CContact, RefusesInvalidOptions) {
  const auto complaint = [&](auto change) {
    auto options = test::sized<palpate_contact_options>();
    EXPECT_EQ(palpate_contact_defaults(shared(), &options), PALPATE_OK);
    change(options);
    int anything = 0;
    palpate_contact* contact = reinterpret_cast<palpate_contact*>(&anything);
    EXPECT_EQ(palpate_contact_create(shared(), &options, &contact), PALPATE_INVALID_ARGUMENT);
    EXPECT_EQ(contact, nullptr);
    return std::string(palpate_last_error());
  };
  EXPECT_THAT(complaint([](auto& o) { o.size = 8; }), HasSubstr("options->size is 8"));
  EXPECT_THAT(complaint([](auto& o) { o.mode = 2; }), HasSubstr("mode is 2"));
  EXPECT_THAT(complaint([](auto& o) { o.method = 2; }), HasSubstr("method 2 "));
  EXPECT_THAT(complaint([](auto& o) { o.friction = -0.1; }), HasSubstr("friction is -0.1"));
  EXPECT_THAT(complaint([](auto& o) { o.grab_distance = test::nan_value; }),
              HasSubstr("grab_distance is nan"));
  EXPECT_THAT(complaint([](auto& o) { o.most_slide = 0; }), HasSubstr("most_slide is 0"));
  EXPECT_THAT(complaint([](auto& o) { o.most_relaxation = -1; }),
              HasSubstr("most_relaxation is -1"));

  auto touch = test::sized<palpate_touch>();
  const double tool[3] = {0, 0, 0};
  const auto contact = test::touchWith(shared());
  EXPECT_INVALID(palpate_contact_update(nullptr, tool, 1, &touch), "contact is NULL");
  EXPECT_INVALID(palpate_contact_update(contact.get(), nullptr, 1, &touch), "tool is NULL");
  EXPECT_INVALID(palpate_contact_update(contact.get(), tool, 1, nullptr), "touch is NULL");
  EXPECT_INVALID(palpate_contact_create(shared(), nullptr, nullptr), "contact is NULL");
  EXPECT_INVALID(palpate_contact_release(nullptr), "contact is NULL");
  palpate_contact_destroy(nullptr);
}

}  // namespace
}  // namespace palpate
