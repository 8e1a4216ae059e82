#include <gtest/gtest.h>

#include <cmath>

#include "viewer/report/field_comparison.hpp"

namespace palpate {
namespace {

/// Force = stiffness * p inside a ball.
class LinearField : public ForceField {
 public:
  LinearField(const Eigen::Matrix3d& stiffness, double covered)
      : stiffness_(stiffness), covered_(covered) {}
  ForceSample evaluate(const Eigen::Vector3d& p) const noexcept override {
    ForceSample sample;
    sample.force = stiffness_ * p;
    sample.inside = p.norm() <= 0.1;
    sample.coverage = p.norm() <= covered_ ? 1 : 0;
    return sample;
  }
  std::string_view name() const override { return "linear"; }

 private:
  Eigen::Matrix3d stiffness_;
  double covered_;
};

Eigen::Matrix3d rotation(double rate) {
  Eigen::Matrix3d matrix;
  matrix << 0, -rate, 0, rate, 0, 0, 0, 0, 0;
  return matrix;
}

TEST(LoopWork, IsZeroWhereTheForceHasAPotential) {
  Eigen::Matrix3d symmetric;
  symmetric << -80, 5, 2, 5, -40, 1, 2, 1, -60;
  EXPECT_LT(loopWork(LinearField(symmetric, 1), 0.1), 1e-12);
}

TEST(LoopWork, DetectsARotationalForce) {
  EXPECT_GT(loopWork(LinearField(rotation(50), 1), 0.1), 0.2);
  EXPECT_LT(loopWork(LinearField(rotation(50) - 1e4 * Eigen::Matrix3d::Identity(), 1), 0.1), 0.01);
}

TEST(LoopWork, LeavesOutCirclesThatAreNotCovered) {
  EXPECT_TRUE(std::isnan(loopWork(LinearField(rotation(1), 1e-3), 0.1, 1)));
  EXPECT_FALSE(std::isnan(loopWork(LinearField(rotation(1), 1e-3), 0.1, 0)));
}

}  // namespace
}  // namespace palpate
