#include "viewer/fields/rbf_field.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/expect_error.hpp"
#include "tests/support/uneven_spaces.hpp"
#include "viewer/fields/field_choice.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::AnalyticEnergy;
using test::pointsInBall;
using test::radius;
using test::solvedSpace;
using test::StiffeningEnergy;

double largestError(const ForceField& field, const AnalyticEnergy& energy, double reach) {
  double largest = 0;
  for (const Vector3d& p : pointsInBall(reach))
    largest = std::max(largest, (field.evaluate(p).force + energy.gradient(p)).norm());
  return largest;
}

/// Cells of three sizes, some of whose corners failed.
SpaceTable refinedWithHoles() {
  return test::without(
      test::splitSpace(Lattice(radius, 0.005, 1024), test::three_sizes, StiffeningEnergy()),
      {{-1024, 0, 0}, {0, 2048, 0}, {512, 512, 0}, {1024, 512, 512}});
}

class EveryRbfField : public ::testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<ForceField> fieldOf(const SpaceTable& space) const {
    return makeForceField(GetParam(), space);
  }
};
INSTANTIATE_TEST_SUITE_P(ForceField, EveryRbfField, ::testing::Values("rbf-linear", "rbf-cubic"),
                         [](const auto& method) {
                           std::string name = method.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(EveryRbfField, AnswersTheWholeBall) {
  const auto field = fieldOf(refinedWithHoles());
  const StiffeningEnergy energy;
  for (const Vector3d& p : pointsInBall(radius, 1000)) {
    const ForceSample sample = field->evaluate(p);
    EXPECT_TRUE(sample.inside);
    EXPECT_LE((sample.force + energy.gradient(p)).norm(),
              0.1 * energy.gradient({radius, 0, 0}).norm());
  }
}

TEST_P(EveryRbfField, GetsMoreAccurateWithTheSpacing) {
  const StiffeningEnergy energy;
  const double coarse =
      largestError(*fieldOf(solvedSpace(Lattice(radius, 0.005), energy)), energy, 0.01);
  const double fine =
      largestError(*fieldOf(solvedSpace(Lattice(radius, 0.0025), energy)), energy, 0.01);
  EXPECT_LT(fine, coarse / 4);
}

TEST(RbfField, RefusesASinglePoint) {
  SpaceTable space = solvedSpace(Lattice(radius, 0.01), StiffeningEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  test::expectError(ExitCode::failed, [&] { makeForceField("rbf-cubic", space); },
                    {"tip", "rbf-cubic", "1 solved point"});
}

}  // namespace
}  // namespace palpate
