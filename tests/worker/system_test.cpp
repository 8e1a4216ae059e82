#include "worker/system.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "worker/kernel_family.hpp"

namespace palpate {
namespace {

using test::mooneyRivlinScene;
using test::youngScene;

Scene with(Scene scene, PressureSpace pressure, Constraint constraint) {
  scene.discretization.pressure = pressure;
  scene.discretization.constraint = constraint;
  return scene;
}

std::vector<Scene> everyFormulation() {
  using enum PressureSpace;
  using enum Constraint;
  return {
      youngScene(LawName::linear),
      youngScene(LawName::st_venant_kirchhoff),
      with(youngScene(LawName::modified_st_venant_kirchhoff, 0.45), p1, det_F_minus_1),
      with(youngScene(LawName::modified_st_venant_kirchhoff, 0.45), p1_stabilized, ln_det_F),
      with(mooneyRivlinScene(), p1, det_F_minus_1),
      with(mooneyRivlinScene(), p1, ln_det_F),
      with(mooneyRivlinScene(), p1_stabilized, det_F_minus_1),
      with(mooneyRivlinScene(), p1_stabilized, ln_det_F),
  };
}

std::string nameOf(const Scene& scene) {
  return std::string(word(scene.regions[0].material.law)) + ", " +
         std::string(word(scene.discretization.pressure)) + ", " +
         std::string(word(scene.discretization.constraint));
}

/// A small clamped body with a patch of several nodes as the tool, at a random admissible state.
class SystemTest : public ::testing::Test {
 protected:
  void prepare(const Scene& scene, const ElementKernels& kernels = chooseKernels()) {
    problem_ = test::clampedProblem(scene, test::distortedBoxMesh({0.2, 0.1, 0.1}, {3, 2, 2}),
                                    {0.2, 0.1, 0.1}, 0.06);
    ASSERT_GT(problem_.active[0].nodes.size(), 1u);
    system_.emplace(problem_, kernels);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::VectorXd step(system_->unknowns());
    for (double& component : step) component = 2e-3 * uniform(random);
    tool_ = Eigen::Vector3d(2e-3, -3e-3, 1e-3);
    state_ = system_->moved(system_->restState(), step, 1, tool_);
    system_->assemble(state_, residual_, tangent_);
  }

  Residual residualAt(const State& state) const {
    Residual residual;
    system_->assemble(state, residual);
    return residual;
  }

  /// The state with one unknown, or the tool, moved by `amount`.
  State nudged(std::int32_t unknown, double amount) const {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(system_->unknowns());
    step[unknown] = amount;
    return system_->moved(state_, step, 1, tool_);
  }
  State toolNudged(int direction, double amount) const {
    const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(system_->unknowns());
    return system_->moved(state_, nothing, 1, tool_ + amount * Eigen::Vector3d::Unit(direction));
  }

  /// Full symmetric matrix of the tangent; rows held by the tool are rows of a multiple of the identity.
  Eigen::MatrixXd dense() const {
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(system_->unknowns(), system_->unknowns());
    for (std::size_t entry = 0; entry < tangent_.values.size(); ++entry) {
      const int row = system_->pattern().row[entry] - 1, column = system_->pattern().column[entry] - 1;
      K(row, column) = K(column, row) = tangent_.values[entry];
    }
    return K;
  }

  bool isHeld(std::int32_t unknown) const {
    return residual_.free[unknown] == 0 && (nudged(unknown, 1e-3).u == state_.u) &&
           (nudged(unknown, 1e-3).q == state_.q);
  }

  Problem problem_;
  std::optional<System> system_;
  Eigen::Vector3d tool_;
  State state_;
  Residual residual_;
  Tangent tangent_;
};

TEST_F(SystemTest, ResidualIsTheDerivativeOfTheEnergy) {
  constexpr double h = 1e-6;
  for (const Scene& scene : everyFormulation()) {
    prepare(scene);
    const double tolerance = 1e-6 * residual_.free.cwiseAbs().maxCoeff();
    for (std::int32_t unknown = 0; unknown < system_->unknowns(); ++unknown) {
      const double slope =
          (residualAt(nudged(unknown, h)).energy - residualAt(nudged(unknown, -h)).energy) / (2 * h);
      ASSERT_NEAR(slope, residual_.free[unknown], tolerance) << nameOf(scene) << ", unknown " << unknown;
    }
    for (int direction = 0; direction < 3; ++direction) {
      const double slope =
          (residualAt(toolNudged(direction, h)).energy - residualAt(toolNudged(direction, -h)).energy) /
          (2 * h);
      ASSERT_NEAR(slope, residual_.tool[direction], tolerance)
          << nameOf(scene) << ", tool direction " << direction;
    }
  }
}

TEST_F(SystemTest, TangentIsTheDerivativeOfTheResidual) {
  constexpr double h = 1e-6;
  for (const Scene& scene : everyFormulation()) {
    prepare(scene);
    const Eigen::MatrixXd K = dense();
    const double tolerance = 1e-6 * K.cwiseAbs().maxCoeff();
    for (std::int32_t unknown = 0; unknown < system_->unknowns(); ++unknown) {
      if (isHeld(unknown)) continue;
      const Residual up = residualAt(nudged(unknown, h)), down = residualAt(nudged(unknown, -h));
      const Eigen::VectorXd column = (up.free - down.free) / (2 * h);
      ASSERT_LT((column - K.col(unknown)).cwiseAbs().maxCoeff(), tolerance)
          << nameOf(scene) << ", unknown " << unknown;
      const Eigen::Vector3d coupling = (up.tool - down.tool) / (2 * h);
      ASSERT_LT((coupling - tangent_.tool_coupling.row(unknown).transpose()).norm(), tolerance)
          << nameOf(scene);
    }
    for (int direction = 0; direction < 3; ++direction) {
      const Residual up = residualAt(toolNudged(direction, h)), down = residualAt(toolNudged(direction, -h));
      ASSERT_LT(((up.tool - down.tool) / (2 * h) - tangent_.tool.col(direction)).norm(), tolerance)
          << nameOf(scene);
      ASSERT_LT(
          ((up.free - down.free) / (2 * h) - tangent_.tool_coupling.col(direction)).cwiseAbs().maxCoeff(),
          tolerance);
    }
  }
}

TEST_F(SystemTest, EveryKernelFamilyComputesTheSameToRounding) {
  for (const Scene& scene : everyFormulation()) {
    prepare(scene, *supportedKernels().back());
    const Residual baseline = residual_;
    const Tangent baseline_tangent = tangent_;
    for (const ElementKernels* kernels : supportedKernels()) {
      prepare(scene, *kernels);
      EXPECT_NEAR(residual_.energy, baseline.energy, 1e-12 * std::abs(baseline.energy)) << kernels->family;
      EXPECT_LT((residual_.free - baseline.free).norm(), 1e-12 * baseline.free.norm()) << kernels->family;
      for (std::size_t entry = 0; entry < tangent_.values.size(); ++entry)
        ASSERT_NEAR(tangent_.values[entry], baseline_tangent.values[entry], 1e-9)
            << kernels->family << ", " << nameOf(scene);
    }
  }
}

TEST_F(SystemTest, ResidualAloneIsTheOneThatComesWithTheTangent) {
  prepare(mooneyRivlinScene());
  const Residual alone = residualAt(state_);
  EXPECT_EQ(alone.free, residual_.free);
  EXPECT_EQ(alone.energy, residual_.energy);
}

TEST_F(SystemTest, RestIsAnEquilibriumOfEveryFormulation) {
  for (const Scene& scene : everyFormulation()) {
    prepare(scene);
    const Residual rest = residualAt(system_->restState());
    EXPECT_LT(rest.norm, 1e-14 * system_->forceScale()) << nameOf(scene);
    EXPECT_EQ(rest.energy, 0) << nameOf(scene);
    EXPECT_EQ(rest.min_det_F, 1) << nameOf(scene);
  }
}

TEST_F(SystemTest, AnInvertedElementIsNamedAndHasNoLogarithm) {
  prepare(mooneyRivlinScene());
  const State inverted = toolNudged(0, -1.0);
  const Residual residual = residualAt(inverted);
  EXPECT_LT(residual.min_det_F, 0);
  EXPECT_GE(residual.worst_element, 0);
  EXPECT_FALSE(std::isfinite(residual.norm));
}

TEST_F(SystemTest, ChangingTheToolAndBackChangesNothing) {
  Scene scene = mooneyRivlinScene();
  scene.fixed.groups = {"xmin"};
  scene.active.resize(2);
  scene.active[0] = {"a", Eigen::Vector3d(0.2, 0.1, 0.1), {}, 0.06};
  scene.active[1] = {"b", Eigen::Vector3d(0.2, 0.05, 0.1), {}, 0.06};
  const Problem problem = resolve(scene, test::boxMesh({0.2, 0.1, 0.1}, {3, 2, 2}));
  System fresh(problem, chooseKernels()), used(problem, chooseKernels());
  used.chooseTool(1);
  used.chooseTool(0);
  const State state =
      fresh.moved(fresh.restState(), Eigen::VectorXd::Constant(fresh.unknowns(), 1e-3), 1, {0, 0, 1e-3});
  Residual a, b;
  Tangent ka, kb;
  fresh.assemble(state, a, ka);
  used.assemble(state, b, kb);
  EXPECT_EQ(a.free, b.free);
  EXPECT_EQ(ka.values, kb.values);
  EXPECT_EQ(ka.tool_coupling, kb.tool_coupling);
  EXPECT_EQ(ka.tool, kb.tool);
}

/// Homogeneous states are exact on any mesh (closed forms: docs/numerics.md). The body is stretched along x
/// with its sides free of stress; the resultant on the end face over its area is the nominal stress.
class HomogeneousState : public ::testing::Test {
 protected:
  /// Nominal stress along x, Pa, in the diagonal deformation `stretches` at pressure `p`; all inner and side
  /// forces must vanish.
  static double nominalStress(const Scene& scene, const Eigen::Vector3d& stretches, double p) {
    const Eigen::Vector3d size(0.2, 0.1, 0.1);
    const Problem problem =
        test::clampedProblem(scene, test::distortedBoxMesh(size, {3, 2, 2}), {0.2, 0.1, 0.1});
    const System system(problem, chooseKernels());
    State state = system.restState();
    for (std::size_t node = 0; node < problem.mesh.nodes.size(); ++node)
      for (int i = 0; i < 3; ++i) state.u[3 * node + i] = (stretches[i] - 1) * problem.mesh.nodes[node][i];
    std::fill(state.q.begin(), state.q.end(), p / system.pressureScale());
    Residual residual;
    Tangent tangent;
    system.assemble(state, residual, tangent);
    // Virtual work of moving the end face x = xmax by one along x: the tool's node is on it.
    double end_force = residual.tool[0], elsewhere = 0;
    std::int32_t unknown = 0;
    std::vector<bool> fixed(problem.mesh.nodes.size());
    for (const std::int32_t node : problem.fixed) fixed[node] = true;
    for (std::size_t node = 0; node < problem.mesh.nodes.size(); ++node) {
      const bool at_end = problem.mesh.nodes[node][0] > size[0] - 1e-9;
      for (int i = 0; i < 3 && !fixed[node]; ++i, ++unknown) {
        if (at_end && i == 0) end_force += residual.free[unknown];
        if (!at_end) elsewhere = std::max(elsewhere, std::abs(residual.free[unknown]));
      }
      if (!state.q.empty()) elsewhere = std::max(elsewhere, std::abs(residual.free[unknown++]));
    }
    EXPECT_LT(elsewhere, 1e-11 * system.forceScale());
    return end_force / (size[1] * size[2]);
  }
};

TEST_F(HomogeneousState, MooneyRivlinInUniaxialStretch) {
  const struct {
    double stretch, stress_kPa;
  } table[] = {{0.5, -27.02},  {0.8, -4.4225}, {0.9, -1.82154}, {1.1, 1.34787},
               {1.2, 2.39296}, {1.5, 4.54593}, {2, 6.79}};
  for (const auto& row : table)
    for (const Constraint constraint : {Constraint::ln_det_F, Constraint::det_F_minus_1})
      for (const PressureSpace pressure : {PressureSpace::p1, PressureSpace::p1_stabilized}) {
        const double l = row.stretch, across = 1 / std::sqrt(l);
        // The pressure that frees the sides: sigma_yy = 0.
        const double c10 = 1300, c01 = 1280, I1 = l * l + 2 / l, I2 = 2 * l + 1 / (l * l);
        const double p = 2 * c10 * (1 / l - I1 / 3) + 2 * c01 * ((I1 - 1 / l) / l - 2 * I2 / 3);
        const double exact = 2 * (l - 1 / (l * l)) * (c10 + c01 / l);
        ASSERT_NEAR(exact / 1000, row.stress_kPa, 1e-4);
        EXPECT_NEAR(nominalStress(with(mooneyRivlinScene(), pressure, constraint), {l, across, across}, p),
                    exact, 1e-9 * std::abs(exact))
            << "stretch " << l;
      }
}

TEST_F(HomogeneousState, StVenantKirchhoffInUniaxialStretch) {
  const double E = 15480, nu = 0.49;
  const struct {
    double stretch, stress_kPa;
  } table[] = {{0.57735, -2.97913}, {0.8, -2.22912}, {1.1, 1.78794}, {1.5, 14.5125}};
  for (const auto& row : table) {
    const double l = row.stretch, across = std::sqrt(1 - nu * (l * l - 1));
    const double exact = E / 2 * l * (l * l - 1);
    ASSERT_NEAR(exact / 1000, row.stress_kPa, 1e-4);
    EXPECT_NEAR(nominalStress(youngScene(LawName::st_venant_kirchhoff, nu), {l, across, across}, 0), exact,
                1e-9 * std::abs(exact));
  }
}

TEST_F(HomogeneousState, ModifiedStVenantKirchhoffWithAndWithoutLambda) {
  for (const bool keep_lambda : {false, true}) {
    Scene scene = youngScene(LawName::modified_st_venant_kirchhoff, 0.49);
    const double E = 15480, nu = 0.49;
    const double mu = keep_lambda ? E / (2 * (1 + nu)) : E / 3;
    const double lambda = keep_lambda ? E * nu / ((1 + nu) * (1 - 2 * nu)) : 0;
    if (!keep_lambda) scene.regions[0].material.poisson.reset();
    for (const double l : {0.6, 0.8, 1.2, 1.5}) {
      const double g1 = (l * l - 1) / 2, g2 = (1 / l - 1) / 2, trace = g1 + 2 * g2;
      const double S1 = lambda * trace + 2 * mu * g1, S2 = lambda * trace + 2 * mu * g2;
      const double p = S2 / l;  // frees the sides: S2 - p C22^-1 = 0
      const double exact = l * (S1 - p / (l * l));
      const double across = 1 / std::sqrt(l);
      EXPECT_NEAR(nominalStress(scene, {l, across, across}, p), exact, 1e-9 * std::abs(exact)) << l;
    }
  }
}

}  // namespace
}  // namespace palpate
