// Compares forces with those of GetFEM 5.4, the finite-element library of the 2010 paper, which
// shares no code with this project. GetFEM has the same mesh and the same fixed nodes, its own
// elements, laws in its language for weak forms, and multipliers at fixed nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "common/mesh/mesh_reader.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/worker/solver/start_at_rest.hpp"

namespace palpate {
namespace {

using test::mooneyRivlinScene;
using test::youngScene;

Scene withElements(Scene scene, DisplacementSpace displacement, PressureSpace pressure) {
  scene.discretization = {displacement, pressure, Constraint::det_F_minus_1};
  return scene;
}

/// On the blob made in code, one node of its end or all nodes of a patch are displaced.
struct GetfemCase {
  const char* name;
  Scene scene;
  double patch;            ///< m
  Eigen::Vector3d target;  ///< m
  Eigen::Vector3d force;   ///< N on the tool
};

std::vector<GetfemCase> cases() {
  using enum DisplacementSpace;
  const Scene linear = youngScene(LawName::linear, 0.49),
              svk = youngScene(LawName::st_venant_kirchhoff, 0.49),
              rubber = withElements(mooneyRivlinScene(), p1, PressureSpace::p1),
              taylor_hood = withElements(mooneyRivlinScene(), p2, PressureSpace::p1),
              modified = withElements(youngScene(LawName::modified_st_venant_kirchhoff, 0.49), p1,
                                      PressureSpace::p1);
  return {
      {"linear", linear, 0, {0.01, 0.02, -0.02}, {-4.909658587, -2.777695801, 2.767342966}},
      {"svk", svk, 0, {0.009, 0.006, 0.009}, {-5.730601475, -0.6259643033, -1.37494636}},
      {"modified", modified, 0, {0.006, -0.01, 0.008}, {-5.748472988, 3.040960709, -1.370266025}},
      {"pulled", rubber, 0, {0.03, 0, 0}, {-10.08012919, 0.3701031471, -0.3336918015}},
      {"across", rubber, 0, {0.01, 0.02, 0.02}, {-3.95882492, -2.396940524, -2.307158411}},
      {"a node",
       taylor_hood,
       0,
       {0.008, 0.004, -0.006},
       {-1.115518896, -0.2165498436, 0.148522999}},
      {"a patch",
       taylor_hood,
       0.03,
       {0.008, 0.004, -0.006},
       {-5.216841792, -0.5282307374, 0.3015339089}}};
}

/// Fixed where x is in the lowest 15 %.
Problem blobOf(const GetfemCase& tested) {
  Scene scene = tested.scene;
  scene.fixed.half_spaces = {{0, true, 0.15, std::nullopt}};
  scene.active = {{.name = "side", .near = Eigen::Vector3d(0.1, 0, 0.02), .radius = tested.patch}};
  return resolve(scene, test::blobMesh());
}

TEST(Getfem, FindsTheSameForces) {
  for (const GetfemCase& tested : cases()) {
    SCOPED_TRACE(tested.name);
    const Problem problem = blobOf(tested);
    EXPECT_EQ(problem.active[0].nodes.size() > 1, tested.patch > 0);
    TransitionSolver solver(problem, chooseKernels());
    Reached reached{{}, test::startAtRest(solver)};
    for (const double share : {1.0 / 3, 2.0 / 3, 1.0}) {
      reached = solver.reach(*reached.end, share * tested.target);
      ASSERT_TRUE(reached.outcome.converged()) << describe(reached.outcome.failure());
    }
    const Eigen::Vector3d force = reached.outcome.equilibrium().force;
    EXPECT_LT((force - tested.force).norm(), 1e-6 * force.norm()) << force.transpose();
  }
}

/// Mooney-Rivlin on the shipped liver; the node at the end of its left lobe is pulled along x.
class Liver : public ::testing::Test {
 protected:
  static Outcome pulled(PressureSpace pressure, Constraint constraint, double metres) {
    Scene scene = mooneyRivlinScene();
    scene.discretization = {.pressure = pressure, .constraint = constraint};
    scene.fixed.spheres = {{{-0.035, 0.056, 0.025}, 0.024}};
    scene.active = {{.name = "tip", .near = Eigen::Vector3d(0.106, -0.020, 0.020)}};
    const Problem problem =
        resolve(scene, readGmsh(PALPATE_SOURCE_DIR "/deploy/scenes/liver/liver-500.msh"));
    TransitionSolver solver(problem, chooseKernels());
    const Outcome outcome = solver.reach(test::startAtRest(solver), {metres, 0, 0}).outcome;
    EXPECT_TRUE(outcome.converged()) << describe(outcome.failure());
    return outcome;
  }
  static double force(PressureSpace pressure, Constraint constraint, double metres) {
    return pulled(pressure, constraint, metres).equilibrium().force.norm();
  }
  /// Largest pressure, Pa. Pulling the tip lowers the pressure under it, so this should stay small.
  static double highestPressure(PressureSpace pressure) {
    return std::ranges::max(
        pulled(pressure, Constraint::det_F_minus_1, 0.01).configuration().fields.pressure);
  }
};

TEST_F(Liver, IsStifferWithTheEqualOrderPressureThanWithItsStabilisation) {
  const double unstable = force(PressureSpace::p1, Constraint::det_F_minus_1, 0.01),
               stabilized = force(PressureSpace::p1_stabilized, Constraint::det_F_minus_1, 0.01);
  EXPECT_GT(unstable, 1.1 * stabilized);
  EXPECT_LT(unstable, 1.5 * stabilized);
}

TEST_F(Liver, HasAPressureThatOscillatesWithoutStabilisation) {
  EXPECT_GT(highestPressure(PressureSpace::p1), 10 * highestPressure(PressureSpace::p1_stabilized));
}

TEST_F(Liver, HasAlmostTheSameForceUnderEitherConstraint) {
  for (const PressureSpace pressure : {PressureSpace::p1, PressureSpace::p1_stabilized})
    for (const auto& [metres, tolerance] : {std::pair(0.001, 0.005), std::pair(0.01, 0.05)}) {
      const double determinant = force(pressure, Constraint::det_F_minus_1, metres);
      const double logarithm = force(pressure, Constraint::ln_det_F, metres);
      EXPECT_NEAR(logarithm, determinant, tolerance * determinant);
      EXPECT_NE(logarithm, determinant);
    }
}

TEST_F(Liver, HasNoPressureAtRestBecauseMooneyRivlinIsIsochoric) {
  // Written in I1 and I2 themselves, the law would need 2 C10 + 4 C01 = 7.72 kPa at rest.
  for (const PressureSpace pressure : {PressureSpace::p1, PressureSpace::p1_stabilized}) {
    const Outcome rest = pulled(pressure, Constraint::det_F_minus_1, 0);
    EXPECT_EQ(rest.cost.newton_iterations, 0);
    for (const float p : rest.configuration().fields.pressure) EXPECT_EQ(p, 0);
  }
}

}  // namespace
}  // namespace palpate
