#include "viewer/haptics/blended_force.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/viewer/haptics/touched_model.hpp"

namespace palpate {
namespace {

class BlendedForceTest : public testing::Test {
 protected:
  static double factorAt(const Eigen::Vector3d& x) {
    return 1 + 0.4 * std::sin(50 * x.x()) + 0.3 * std::cos(70 * x.y());
  }
  std::int32_t topTriangle() const {
    for (std::int32_t t = 0; t < static_cast<std::int32_t>(model.surface().triangles().size()); ++t)
      if (model.surface().faceNormal(t).z() > 0.9) return t;
    return -1;
  }
  static const HapticModel& shared() {
    static const HapticModel model = test::cubeModel(factorAt);
    return model;
  }
  const HapticModel& model = shared();
};

TEST_F(BlendedForceTest, IsTheWeightedSumOverTheSpaces) {
  const SurfacePoint anchor{topTriangle(), {0.2, 0.3, 0.5}};
  const Eigen::Vector3d p(0.003, -0.001, -0.008);
  BlendedForce force;
  force.evaluate(model, 0, anchor, p);
  ASSERT_EQ(force.blend().size, 3);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double energy = 0;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto& [space, weight] = force.blend().shares[n];
    const ForceSample sample = model.field(0, static_cast<std::size_t>(space)).evaluate(p);
    sum += weight * sample.force;
    energy += weight * sample.energy;
  }
  EXPECT_LT((force.force() - sum).norm(), 1e-15);
  EXPECT_NEAR(force.sum().energy, energy, 1e-17);
  EXPECT_TRUE(force.sum().inside);
}

TEST_F(BlendedForceTest, KnowsHowEnergyAndForceChangeWhenTheAnchorMoves) {
  const TouchSurface& surface = model.surface();
  const std::int32_t triangle = topTriangle();
  const SurfacePoint anchor{triangle, {0.2, 0.3, 0.5}};
  const Eigen::Vector3d tool = surface.position(anchor) + Eigen::Vector3d(0.0031, -0.0012, -0.0083);
  BlendedForce force;
  const auto evaluateAt = [&](const Eigen::Vector3d& step) {
    SurfacePoint point = anchor;
    point.barycentric += surface.barycentricGradients(triangle).transpose() * step;
    force.evaluate(model, 0, point, tool - surface.position(point));
  };
  evaluateAt({0, 0, 0});
  const AnchorSlope slope = force.slopeAlong(triangle);
  EXPECT_NEAR(slope.tangent.z(), 0, 1e-15);
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.6, 0.8, 0)}) {
    constexpr double h = 1e-6;
    evaluateAt(h * direction);
    const double after = force.sum().energy;
    const Eigen::Vector3d force_after = force.force(),
                          tangent_after = force.slopeAlong(triangle).tangent;
    evaluateAt(-h * direction);
    const Eigen::Vector3d tangent_before = force.slopeAlong(triangle).tangent;
    EXPECT_NEAR(slope.tangent.dot(direction), (after - force.sum().energy) / (2 * h), 1e-6);
    EXPECT_LT((slope.change * direction - (force_after - force.force()) / (2 * h)).norm(), 1e-3);
    EXPECT_NEAR(direction.dot(slope.hessian * direction),
                direction.dot(tangent_after - tangent_before) / (2 * h), 1e-3);
  }
}

TEST_F(BlendedForceTest, SlidesByTheForceAloneWithoutAnEnergy) {
  const SurfacePoint anchor{topTriangle(), {0.2, 0.3, 0.5}};
  BlendedForce force;
  force.evaluate(model, 1, anchor, {0.003, -0.001, -0.008});
  EXPECT_TRUE(std::isnan(force.sum().energy));
  const Eigen::Vector3d tangent = force.slopeAlong(anchor.triangle).tangent;
  EXPECT_LT((tangent.head<2>() - force.force().head<2>()).norm(), 1e-15);
}

}  // namespace
}  // namespace palpate
