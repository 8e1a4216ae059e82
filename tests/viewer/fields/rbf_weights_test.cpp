#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/expect_error.hpp"
#include "tests/support/sample_dataset.hpp"
#include "viewer/fields/rbf_field.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::solvedSpace;
using test::StiffeningEnergy;

/// The sum described at RbfWeights, in plain code, without unsolved points.
Vector3d forceAt(const SpaceTable& space, RbfKernel kernel, const RbfWeights& rbf,
                 const Vector3d& p) {
  Vector3d force = Vector3d::Zero();
  Eigen::Index row = 0;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[n].tag)) continue;
    const double r = (p - space.lattice.displacement(n)).norm() / space.lattice.spacing();
    force += (kernel == RbfKernel::linear ? r : r * r * r) * rbf.weights.row(row++).transpose();
  }
  return force;
}

class EveryKernel : public ::testing::TestWithParam<RbfKernel> {};
INSTANTIATE_TEST_SUITE_P(RbfWeights, EveryKernel,
                         ::testing::Values(RbfKernel::linear, RbfKernel::cubic),
                         [](const auto& kernel) {
                           return kernel.param == RbfKernel::linear ? "linear" : "cubic";
                         });

TEST_P(EveryKernel, ReproducesTheForceOfEverySolvedPoint) {
  SpaceTable space = solvedSpace(Lattice(0.02, 0.005), StiffeningEnergy());
  space.points[7].tag = Tag::failed;
  space.points[7].equilibrium.force.setConstant(1e9);  // must not be read
  const RbfWeights rbf = solveRbfWeights(space, GetParam());
  EXPECT_TRUE(rbf.accurate());
  EXPECT_GT(rbf.condition, 10);
  EXPECT_EQ(rbf.weights.rows(), space.lattice.size() - 1);
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (n == 7) continue;
    const Vector3d& force = space.points[n].equilibrium.force;
    const Vector3d p = space.lattice.displacement(n);
    EXPECT_LE((forceAt(space, GetParam(), rbf, p) - force).norm(), 1e-11);
  }
}

TEST_P(EveryKernel, HasNoWeightsForASinglePoint) {
  SpaceTable space = solvedSpace(Lattice(0.02, 0.01), StiffeningEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  for (const double force : {0.0, 2.0}) {
    space.points[0].equilibrium.force.setConstant(force);
    EXPECT_FALSE(solveRbfWeights(space, GetParam()).accurate());
  }
}

TEST_P(EveryKernel, HasWeightsForPointsInAPlane) {
  SpaceTable space = solvedSpace(Lattice(0.02, 0.005), StiffeningEnergy());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.point(n)[2] != 0) space.points[n].tag = Tag::failed;
  EXPECT_TRUE(solveRbfWeights(space, GetParam()).accurate());
}

TEST_P(EveryKernel, RefusesTooManyPointsAndNone) {
  SpaceTable space = solvedSpace(Lattice(0.1, 0.1 / 11), StiffeningEnergy());
  test::expectError(ExitCode::failed, [&] { solveRbfWeights(space, GetParam()); },
                    {"tip", std::to_string(space.lattice.size()), "too many", "at most 5000"});
  for (PointRecord& point : space.points) point = {};
  test::expectError(ExitCode::failed, [&] { solveRbfWeights(space, GetParam()); },
                    {"tip", "no lattice point was solved"});
}

}  // namespace
}  // namespace palpate
