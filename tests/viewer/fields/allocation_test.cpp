#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <new>
#include <vector>

#include "tests/support/sample_dataset.hpp"
#include "tests/viewer/haptics/touched_model.hpp"
#include "viewer/fields/displacement_field.hpp"
#include "viewer/fields/field_choice.hpp"
#include "viewer/haptics/contact.hpp"
#include "viewer/haptics/deformed_shape.hpp"

namespace {
std::atomic<long> allocations = 0;
}

// Counts every allocation of this test program. Not inline: GCC would warn that free() does not
// match new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace palpate {
namespace {

TEST(CountingAllocator, Counts) {
  const long before = allocations;
  void* const memory = ::operator new(1);
  const long after = allocations;
  ::operator delete(memory);
  EXPECT_EQ(after, before + 1);
}

TEST(ForceField, EvaluatesWithoutAllocating) {
  const Lattice lattice(0.02, 0.005);
  const SpaceTable space = test::solvedSpace(lattice, test::StiffeningEnergy());
  for (const std::string& method : forceFieldMethods()) {
    const auto field = makeForceField(method, space);
    const long before = allocations;
    double sum = 0;
    for (int n = 0; n < 1000; ++n)
      sum += field->evaluate({3e-5 * n - 0.015, 1e-5 * n, -2e-5 * n}).force.x();
    EXPECT_EQ(allocations, before) << method;
    EXPECT_TRUE(std::isfinite(sum));
  }
}

TEST(ForceField, EvaluatesWithoutAllocatingWhereCornersAreMissingBranchesMeetAndOutside) {
  SpaceTable space = test::solvedSpace(Lattice(0.02, 0.005), test::StiffeningEnergy());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (space.lattice.point(n)[0] > 1) space.points[n].equilibrium.force.y() += 3;
    if (space.lattice.point(n)[1] < -2) space.points[n] = {};
  }
  for (const std::string& method : forceFieldMethods()) {
    const auto field = makeForceField(method, space);
    const long before = allocations;
    double sum = 0;
    for (int n = 0; n < 1000; ++n)
      sum += field->evaluate({5e-5 * n - 0.025, -2e-5 * n, 0.001}).force.x();
    sum += field->evaluate({std::nan(""), 1e300, 0}).force.x();
    EXPECT_EQ(allocations, before) << method;
    EXPECT_TRUE(std::isfinite(sum)) << method;
  }
}

TEST(DisplacementField, EvaluatesWithoutAllocating) {
  const SpaceTable space = test::solvedSpace(Lattice(0.02, 0.005), test::StiffeningEnergy());
  const DisplacementField field(space, std::vector<float>(space.points.size() * 30, 1e-3f));
  std::array<float, 30> shape;
  const long before = allocations;
  for (int n = 0; n < 1000; ++n) field.evaluate({5e-5 * n - 0.025, -2e-5 * n, 0.001}, shape);
  EXPECT_EQ(allocations, before);
}

TEST(Contact, TouchesSlidesReleasesAndSwitchesWithoutAllocating) {
  const HapticModel model = test::tenNodeModel(), other = test::tenNodeModel();
  for (const ContactMode mode : {ContactMode::unilateral, ContactMode::glued}) {
    Contact contact(model, {.mode = mode});
    int touched = 0;
    const long before = allocations;
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
    EXPECT_EQ(allocations, before);
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
  const long before = allocations;
  shape.evaluate(model, contact.touch(), out);
  shape.evaluate(model, Touch{}, out);
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace palpate
