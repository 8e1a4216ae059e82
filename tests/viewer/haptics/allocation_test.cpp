// Allocations of functions that may be called in a tick, besides the tick itself. A separate
// program, because it replaces the C library's allocator.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "common/problem/sites.hpp"
#include "tests/support/finger_body.hpp"
#include "tests/support/sample_dataset.hpp"
#include "tests/viewer/haptics/counted_calls.hpp"
#include "tests/viewer/haptics/touched_model.hpp"
#include "viewer/fields/area_field.hpp"
#include "viewer/fields/displacement_field.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/deformed_shape.hpp"

namespace palpate {
namespace {

TEST(ForceField, EvaluatesWithoutAllocating) {
  const Lattice lattice(0.02, 0.005);
  const SpaceTable space = test::solvedSpace(lattice, test::StiffeningEnergy());
  for (const std::string& method : forceFieldMethods()) {
    const auto field = makeForceField(method, space);
    test::startCounting();
    double sum = 0;
    for (int n = 0; n < 1000; ++n)
      sum += field->evaluate({3e-5 * n - 0.015, 1e-5 * n, -2e-5 * n}).force.x();
    EXPECT_EQ(test::stopCounting().allocations, 0) << method;
    EXPECT_TRUE(std::isfinite(sum));
  }
}

TEST(ForceField, EvaluatesWithoutAllocatingAtGapsJumpsAndOutside) {
  SpaceTable space = test::solvedSpace(Lattice(0.02, 0.005), test::StiffeningEnergy());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (space.lattice.point(n)[0] > 1) space.points[n].equilibrium.force.y() += 3;
    if (space.lattice.point(n)[1] < -2) space.points[n] = {};
  }
  for (const std::string& method : forceFieldMethods()) {
    const auto field = makeForceField(method, space);
    test::startCounting();
    double sum = 0;
    for (int n = 0; n < 1000; ++n)
      sum += field->evaluate({5e-5 * n - 0.025, -2e-5 * n, 0.001}).force.x();
    sum += field->evaluate({std::nan(""), 1e300, 0}).force.x();
    EXPECT_EQ(test::stopCounting().allocations, 0) << method;
    EXPECT_TRUE(std::isfinite(sum)) << method;
  }
}

TEST(AreaField, EvaluatesWithoutAllocatingInsideAndOutside) {
  const test::FingerBody body;
  std::vector<const SpaceTable*> sites;
  for (const SpaceTable& space : body.spaces) sites.push_back(&space);
  const AreaField area(sites, placesAround(body.problem.mesh, centersOf(sites), 0.02));
  test::startCounting();
  double sum = 0;
  for (int n = 0; n < 1000; ++n)
    sum += area.evaluate({1e-4 * n, 0.05, 0.1}, {5e-5 * n - 0.025, -2e-5 * n, -0.001}).drive.x();
  sum += area.evaluate({std::nan(""), 0, 0}, {0, 0, 0}).force.x();
  sum += area.evaluate({0.05, 0.05, 0.1}, {1e300, 0, 0}).force.x();
  EXPECT_EQ(test::stopCounting().allocations, 0);
  EXPECT_TRUE(std::isfinite(sum));
}

TEST(DisplacementField, EvaluatesWithoutAllocating) {
  const SpaceTable space = test::solvedSpace(Lattice(0.02, 0.005), test::StiffeningEnergy());
  const DisplacementField field(space, std::vector<float>(space.points.size() * 30, 1e-3f));
  std::array<float, 30> shape;
  test::startCounting();
  for (int n = 0; n < 1000; ++n) field.evaluate({5e-5 * n - 0.025, -2e-5 * n, 0.001}, shape);
  EXPECT_EQ(test::stopCounting().allocations, 0);
}

TEST(Contact, TouchesSlidesReleasesAndSwitchesWithoutAllocating) {
  const HapticModel model = test::tenNodeModel(), other = test::tenNodeModel();
  for (const ContactMode mode : {ContactMode::unilateral, ContactMode::glued}) {
    Contact contact(model, {.mode = mode});
    int touched = 0;
    test::startCounting();
    for (int n = 0; n < 20000; ++n) {
      const double t = 0.001 * n;
      const Touch& touch = contact.update(
          {0.06 * std::sin(3.1 * t), 0.03 * std::sin(4.3 * t), 0.055 - 0.01 * std::sin(9 * t)},
          n % 500 > 50);
      touched += touch.touching ? 1 : 0;
      if (n % 1000 == 0)
        contact.use(n % 2000 == 0 ? model : other, static_cast<std::size_t>(n / 1000 % 2));
      if (n % 3000 == 0) contact.release();
      if (n % 3500 == 0) contact.update({std::nan(""), 0, 0});
    }
    EXPECT_EQ(test::stopCounting().allocations, 0);
    EXPECT_GT(touched, 1000);
  }
}

TEST(DeformedShape, EvaluatesWithoutAllocating) {
  const HapticModel model = test::tenNodeModel();
  DeformedShape shape(model.surface().vertices().size());
  std::vector<float> out(3 * model.surface().vertices().size());
  Contact contact(model);
  for (int n = 0; n < 300; ++n) contact.update({0.01, 0.01, 0.07 - 1e-4 * n});
  ASSERT_TRUE(contact.touch().touching);
  test::startCounting();
  shape.evaluate(model, contact.touch(), out);
  shape.evaluate(model, Touch{}, out);
  EXPECT_EQ(test::stopCounting().allocations, 0);
}

}  // namespace
}  // namespace palpate
