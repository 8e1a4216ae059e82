#include "common/space/expansion.hpp"

#include <gtest/gtest.h>

#include <random>

namespace palpate {
namespace {

Expansion arbitrary() {
  std::mt19937 random(7);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
  const auto fill = [&](auto& matrix) {
    for (auto& entry : matrix.reshaped()) entry = number();
  };
  Expansion expansion;
  Equilibrium& e = expansion.equilibrium;
  fill(expansion.place);
  fill(expansion.displacement);
  e.energy = number();
  fill(e.force);
  fill(e.drive);
  fill(e.stiffness);
  fill(e.drive_stiffness);
  fill(e.drive_slope);
  e.stiffness = (e.stiffness + e.stiffness.transpose()).eval();
  e.drive_slope = (e.drive_slope + e.drive_slope.transpose()).eval();
  // stiffness_by_p is symmetric in all three axes: the third derivatives of (a . p)^3 + (b . p)^3.
  for (int term = 0; term < 2; ++term) {
    Eigen::Vector3d a;
    fill(a);
    for (std::size_t c = 0; c < symmetric_axes.size(); ++c)
      for (int k = 0; k < 3; ++k)
        e.stiffness_by_p(static_cast<Eigen::Index>(c), k) +=
            a[symmetric_axes[c][0]] * a[symmetric_axes[c][1]] * a[k];
  }
  fill(e.stiffness_by_s);
  fill(e.drive_slope_by_p);
  return expansion;
}

const Eigen::Vector3d s(0.3, -0.2, 0.5), p(-0.4, 0.6, 0.1);

TEST(Expansion, IsTheEquilibriumWhereItWasMade) {
  const Expansion expansion = arbitrary();
  const auto sample = expansion.at(expansion.place, expansion.displacement);
  EXPECT_EQ(sample.energy, expansion.equilibrium.energy);
  EXPECT_EQ(sample.force, expansion.equilibrium.force);
  EXPECT_EQ(sample.drive, expansion.equilibrium.drive);
  EXPECT_EQ(sample.last_terms, 0);
}

TEST(Expansion, HasForceAndDriveThatAreTheGradientOfItsEnergy) {
  const Expansion expansion = arbitrary();
  const auto here = expansion.at(s, p);
  constexpr double h = 1e-5;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
    EXPECT_NEAR((expansion.at(s, p + e).energy - expansion.at(s, p - e).energy) / (2 * h),
                -here.force[i], 1e-8);
    EXPECT_NEAR((expansion.at(s + e, p).energy - expansion.at(s - e, p).energy) / (2 * h),
                -here.drive[i], 1e-8);
  }
}

TEST(Expansion, HasForcesThatAreTheGradientOfItsEnergyWithAHoldThatMoves) {
  Expansion expansion = arbitrary();
  Held& held = expansion.held.emplace();
  held.at = {{0.5, -0.2, 0.3}, {0.1, 0.2, -0.1}};
  held.force << 0.3, -0.7, 0.2, 0.4, 0.1, -0.5;
  const Vector6d arbitrary_column = Vector6d::LinSpaced(-0.4, 1.3);
  held.stiffness = arbitrary_column * arbitrary_column.transpose() + Matrix6d::Identity();
  held.hand_by_hold = held.force * arbitrary_column.transpose() - 2 * Matrix6d::Identity();
  const Hold hold = {{0.2, 0.1, 0.4}, {0.4, -0.1, 0.3}};
  const auto here = expansion.at(s, p, hold);
  constexpr double h = 1e-5;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
    const auto slope = [&](const auto& up, const auto& down) {
      return (up.energy - down.energy) / (2 * h);
    };
    EXPECT_NEAR(slope(expansion.at(s, p + e, hold), expansion.at(s, p - e, hold)), -here.force[i],
                1e-8);
    EXPECT_NEAR(slope(expansion.at(s + e, p, hold), expansion.at(s - e, p, hold)), -here.drive[i],
                1e-8);
    EXPECT_NEAR(slope(expansion.at(s, p, Hold{hold.place, hold.displacement + e}),
                      expansion.at(s, p, Hold{hold.place, hold.displacement - e})),
                -here.hold_force[i], 1e-8);
  }
}

TEST(Expansion, HasTheDerivativesOfTheEquilibrium) {
  const Expansion expansion = arbitrary();
  const Equilibrium& e = expansion.equilibrium;
  constexpr double h = 1e-4;
  const auto force = [&](const Eigen::Vector3d& ds, const Eigen::Vector3d& dp) {
    return expansion.at(expansion.place + ds, expansion.displacement + dp).force;
  };
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(i);
    EXPECT_LT(((force(none, step) - force(none, -step)) / (2 * h) - e.stiffness.col(i)).norm(),
              1e-7);
    EXPECT_LT(
        ((force(step, none) - force(-step, none)) / (2 * h) - e.drive_stiffness.row(i).transpose())
            .norm(),
        1e-7);
    // The force's second differences along p and s are columns of the slopes.
    const Eigen::Vector3d pp = (force(none, step) - 2 * e.force + force(none, -step)) / (h * h);
    const Eigen::Vector3d ss = (force(step, none) - 2 * e.force + force(-step, none)) / (h * h);
    for (std::size_t c = 0; c < symmetric_axes.size(); ++c) {
      const auto [a, b] = symmetric_axes[c];
      const auto row = static_cast<Eigen::Index>(c);
      if (a != i) continue;
      EXPECT_NEAR(pp[b], e.stiffness_by_p(row, i), 1e-5);
      for (int k = 0; b == i && k < 3; ++k) EXPECT_NEAR(ss[k], e.drive_slope_by_p(row, k), 1e-5);
    }
  }
}

}  // namespace
}  // namespace palpate
