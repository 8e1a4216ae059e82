#include "viewer/haptics/deformed_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

class DeformedShapeTest : public testing::Test {
 protected:
  static const HapticModel& shared() {
    static const HapticModel model = test::cubeModel();
    return model;
  }
  std::vector<float> shapeOf(const Touch& touch) {
    std::vector<float> out(3 * model.surface().vertices().size(), 7.0f);
    shape.evaluate(model, touch, out);
    return out;
  }
  Eigen::Vector3d displacementAt(const std::vector<float>& out, const SurfacePoint& point) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Triangle& t = model.surface().triangles()[static_cast<std::size_t>(point.triangle)];
    for (std::size_t c = 0; c < 3; ++c)
      for (Eigen::Index a = 0; a < 3; ++a)
        sum[a] += point.barycentric[static_cast<Eigen::Index>(c)] *
                  static_cast<double>(
                      out[3 * static_cast<std::size_t>(t[c]) + static_cast<std::size_t>(a)]);
    return sum;
  }
  const HapticModel& model = shared();
  DeformedShape shape{model.surface().vertices().size()};
};

TEST_F(DeformedShapeTest, PassesThroughTheToolWhileSliding) {
  Contact contact(model, {.friction = 0.1});
  double largest_step = 0;
  std::vector<float> last;
  for (int n = 0; n < 800; ++n) {
    const double along = 1e-4 * std::max(0, n - 150);
    const Touch& touch =
        contact.update({0.02 + along, 0.03 + 0.5 * along, 0.1 - std::min(1e-4 * n, 0.012)});
    if (!touch.touching) continue;
    const std::vector<float> out = shapeOf(touch);
    EXPECT_LT((displacementAt(out, touch.anchor) - touch.displacement).norm(), 1e-8);
    for (std::size_t i = 0; i < last.size(); ++i)
      largest_step = std::max(largest_step, static_cast<double>(std::abs(out[i] - last[i])));
    last = out;
  }
  EXPECT_GT(largest_step, 1e-5);
  EXPECT_LT(largest_step, 5e-4);  // the tool moves 0.1 mm per tick
}

TEST_F(DeformedShapeTest, ChangesNothingFarFromTheAnchor) {
  Contact contact(model, {.friction = 10});
  for (int n = 0; n <= 100; ++n) contact.update({0.05, 0.04, 0.1001 - 1e-4 * n});
  const Touch& touch = contact.touch();
  ASSERT_TRUE(touch.touching);
  const std::vector<float> out = shapeOf(touch);
  for (std::size_t v = 0; v < model.surface().vertices().size(); ++v) {
    if ((model.surface().vertices()[v] - touch.anchor_position).norm() < 0.075)
      continue;  // edges are at most 0.036 long
    double expected = 0;
    for (std::int32_t n = 0; n < touch.blend.size; ++n) {
      const auto& [space, weight] = touch.blend.shares[static_cast<std::size_t>(n)];
      std::vector<float> one(out.size());
      model.shape(static_cast<std::size_t>(space)).evaluate(touch.displacement, one);
      expected += weight * static_cast<double>(one[3 * v + 2]);
    }
    EXPECT_NEAR(static_cast<double>(out[3 * v + 2]), expected, 1e-9);
  }
}

TEST_F(DeformedShapeTest, PassesThroughBothTools) {
  const auto pressedAt = [&](double x, double depth) {
    Contact contact(model, {.friction = 10});
    for (int n = 0; n <= 100; ++n) contact.update({x, 0.05, 0.1001 - 1e-2 * n * depth});
    EXPECT_TRUE(contact.touch().touching);
    return contact.touch();
  };
  const std::vector<Touch> both = {pressedAt(0.03, 0.008), pressedAt(0.07, 0.006)};
  std::vector<float> out(3 * model.surface().vertices().size());
  shape.evaluate(model, both, out);
  for (const Touch& touch : both)
    EXPECT_LT((displacementAt(out, touch.anchor) - touch.displacement).norm(), 2e-5);
  const std::vector<float> one = shapeOf(both[0]), other = shapeOf(both[1]);
  EXPECT_GT((displacementAt(one, both[1].anchor)).norm(), 1e-4) << "one moves the other's place";
  shape.evaluate(model, std::vector<Touch>{Touch(), both[1]}, out);
  EXPECT_EQ(out, other);
}

TEST_F(DeformedShapeTest, IsAtRestWhenNothingIsTouched) {
  EXPECT_TRUE(std::ranges::all_of(shapeOf(Touch{}), [](float x) { return x == 0; }));
}

}  // namespace
}  // namespace palpate
