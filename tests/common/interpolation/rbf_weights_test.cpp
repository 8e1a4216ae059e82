#include "common/interpolation/rbf_weights.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "common/dataset/dataset.hpp"
#include "common/interpolation/conditional_system.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/sample_dataset.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using test::solvedSpace;
using test::StiffeningEnergy;

double phi(RbfKernel kernel, double r) { return kernel == RbfKernel::linear ? r : r * r * r; }

/// The sum that RbfWeights describes, written down plainly. Unsolved points are left out.
Vector3d forceAt(const SpaceTable& space, const RbfWeights& rbf, const Vector3d& p) {
  const double h = space.lattice.spacing();
  Vector3d force = Vector3d::Zero();
  Eigen::Index row = 0;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (isSolved(space.points[n].tag))
      force += phi(rbf.kernel, (p - space.lattice.displacement(n)).norm() / h) *
               rbf.weights.row(row++).transpose();
  if (rbf.tail.rows() > 0) force += rbf.tail.row(0).transpose();
  if (rbf.tail.rows() > 1) force += rbf.tail.bottomRows<3>().transpose() * p / h;
  return force;
}

class EveryKernel : public ::testing::TestWithParam<RbfKernel> {};
INSTANTIATE_TEST_SUITE_P(RbfWeights, EveryKernel,
                         ::testing::Values(RbfKernel::linear, RbfKernel::cubic),
                         [](const auto& kernel) {
                           return kernel.param == RbfKernel::linear ? "linear" : "cubic";
                         });

TEST_P(EveryKernel, GivesTheForceOfEverySolvedPoint) {
  SpaceTable space = solvedSpace(Lattice(0.02, 0.005), StiffeningEnergy());
  space.points[7].tag = Tag::failed;
  space.points[7].equilibrium.force.setConstant(1e9);  // must not be looked at
  const auto both = solveRbfWeights(space, GetParam());
  ASSERT_EQ(both.size(), 2u);
  for (const RbfWeights& rbf : both) {
    EXPECT_TRUE(rbf.accurate());
    EXPECT_EQ(rbf.weights.rows(), space.lattice.size() - 1);
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      if (n == 7) continue;
      const Vector3d& force = space.points[n].equilibrium.force;
      EXPECT_LE((forceAt(space, rbf, space.lattice.displacement(n)) - force).norm(), 1e-11);
    }
  }
}

TEST_P(EveryKernel, ReproducesItsTail) {
  SpaceTable space = solvedSpace(Lattice(0.02, 0.005), StiffeningEnergy());
  const auto polynomial = [&](const Vector3d& p) -> Vector3d {
    const Vector3d constant(1, -2, 3);
    return GetParam() == RbfKernel::linear ? constant
                                           : constant + 50 * Vector3d(p.y(), p.z() - p.x(), p.x());
  };
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    space.points[n].equilibrium.force = polynomial(space.lattice.displacement(n));
  const auto both = solveRbfWeights(space, GetParam());
  const Vector3d p(0.0123, -0.004, 0.0071), far = 10 * p;
  EXPECT_LE((forceAt(space, both[1], p) - polynomial(p)).norm(), 1e-10);
  EXPECT_LE((forceAt(space, both[1], far) - polynomial(far)).norm(), 1e-10);
  EXPECT_GT((forceAt(space, both[0], far) - polynomial(far)).norm(), 1e-3) << "there is no tail";
}

TEST_P(EveryKernel, SumsOfWeightsVanishWithATail) {
  const SpaceTable space = solvedSpace(Lattice(0.02, 0.005), StiffeningEnergy());
  const auto both = solveRbfWeights(space, GetParam());
  EXPECT_LE(both[1].weights.colwise().sum().norm(), 1e-10 * both[1].weights.norm());
  EXPECT_GT(both[0].weights.colwise().sum().norm(), 1e-10 * both[0].weights.norm());
}

TEST_P(EveryKernel, GivesTheSameBitsTwice) {
  const SpaceTable space = solvedSpace(Lattice(0.02, 0.005), StiffeningEnergy());
  const auto first = solveRbfWeights(space, GetParam()),
             second = solveRbfWeights(space, GetParam());
  for (std::size_t n : {0, 1}) {
    EXPECT_EQ(first[n].weights, second[n].weights);
    EXPECT_EQ(first[n].tail, second[n].tail);
  }
}

TEST_P(EveryKernel, OfASinglePointIsATailOrNothing) {
  SpaceTable space = solvedSpace(Lattice(0.02, 0.01), StiffeningEnergy());
  for (std::int32_t n = 1; n < space.lattice.size(); ++n) space.points[n].tag = Tag::failed;
  space.points[0].equilibrium.force = Vector3d(1, 2, 3);
  const auto both = solveRbfWeights(space, GetParam());
  EXPECT_FALSE(both[0].accurate());
  EXPECT_TRUE(both[1].accurate());
  EXPECT_LE((forceAt(space, both[1], {0.003, 0, 0}) - Vector3d(1, 2, 3)).norm(), 1e-14);
}

TEST_P(EveryKernel, IsFoundForPointsInAPlane) {
  SpaceTable space = solvedSpace(Lattice(0.02, 0.005), StiffeningEnergy());
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (space.lattice.point(n)[2] != 0) space.points[n].tag = Tag::failed;
  for (const RbfWeights& rbf : solveRbfWeights(space, GetParam())) EXPECT_TRUE(rbf.accurate());
}

TEST_P(EveryKernel, RefusesTooManyPointsAndNone) {
  SpaceTable space = solvedSpace(Lattice(0.1, 0.1 / 11), StiffeningEnergy());
  test::expectError(ExitCode::failed, [&] { solveRbfWeights(space, GetParam()); },
                    {"tip", std::to_string(space.lattice.size()), "too many", "at most 5000"});
  for (PointRecord& point : space.points) point = {};
  test::expectError(ExitCode::failed, [&] { solveRbfWeights(space, GetParam()); },
                    {"tip", "no lattice point was solved"});
}

TEST(ConditionalSystem, SaysThatCoincidingPointsAreNotDefinite) {
  Eigen::MatrixXd A(3, 3);
  A << 0, -0.0, -1, -0.0, 0, -1, -1, -1, 0;  // -r of the places 0, 0, 1
  const ConditionalSystem system(A, Eigen::MatrixXd::Ones(3, 1));
  EXPECT_FALSE(system.definite());
  EXPECT_TRUE(std::isinf(system.condition()));
}

TEST(ConditionalSystem, LeavesOutColumnsThatDependOnEarlierOnes) {
  Eigen::MatrixXd A(4, 4), P(4, 3);
  const std::vector<double> x = {0, 1, 2.5, 4};
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index j = 0; j < 4; ++j)
      A(i, j) =
          std::pow(std::abs(x[static_cast<std::size_t>(i)] - x[static_cast<std::size_t>(j)]), 3);
  P << 1, 2, 0, 1, 2, 1, 1, 2, 2.5, 1, 2, 4;
  const ConditionalSystem system(A, P);
  ASSERT_TRUE(system.definite());
  const Eigen::Vector4d f(1, 3, -2, 5);
  const auto [weights, tail] = system.withTail(f);
  EXPECT_LE((A * weights + P * tail - f).norm(), 1e-12);
  EXPECT_LE((P.transpose() * weights).norm(), 1e-12);
  EXPECT_EQ(tail(1, 0), 0);
  EXPECT_LE((A * system.withoutTail(f) - f).norm(), 1e-12);
}

}  // namespace
}  // namespace palpate
