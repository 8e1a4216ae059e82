#include "worker/solver/transition.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <atomic>
#include <optional>
#include <thread>

#include "tests/support/body_models.hpp"
#include "tests/support/command.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/worker/solver/dense_tangent.hpp"
#include "tests/worker/solver/start_at_rest.hpp"

namespace palpate {
namespace {

using test::mooneyRivlinScene;
using test::youngScene;

const Eigen::Vector3d blob_tip(0.1, 0, 0);

/// A solver at the rest state of a body, ready to move the tool.
class TransitionTest : public ::testing::Test {
 protected:
  void clamp(const Scene& scene, double patch_radius = 0) {
    clamp(test::clampedProblem(scene, test::blobMesh(), blob_tip, patch_radius));
  }
  void clamp(Problem problem, TransitionOptions options = {}) {
    solver_.reset();
    problem_ = std::move(problem);
    solver_.emplace(problem_, chooseKernels(), options);
    rest_ = test::startAtRest(*solver_);
  }
  Outcome reach(const Eigen::Vector3d& target) { return solver_->reach(rest_, target).outcome; }
  Equilibrium equilibriumAt(const Eigen::Vector3d& target) {
    const Outcome outcome = reach(target);
    EXPECT_TRUE(outcome.converged()) << describe(outcome.failure());
    return outcome.equilibrium();
  }
  /// Compares forces and stiffness with differences of energy and force.
  Equilibrium expectDerivativesOfOneEnergy(const Eigen::Vector3d& target, double tolerance = 1e-6) {
    constexpr double h = 1e-5;
    Equilibrium here = equilibriumAt(target);
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
      const Equilibrium up = equilibriumAt(target + e), down = equilibriumAt(target - e);
      EXPECT_NEAR((up.energy - down.energy) / (2 * h), -here.force[i],
                  tolerance * here.force.norm());
      EXPECT_LT(((up.force - down.force) / (2 * h) - here.stiffness.col(i)).norm(),
                tolerance * here.stiffness.norm());
    }
    return here;
  }

  Problem problem_;
  std::optional<TransitionSolver> solver_;
  Start rest_;
};

TEST_F(TransitionTest, ForceIsMinusTheGradientOfTheEnergyAndStiffnessItsDerivative) {
  const Eigen::Vector3d target(0.008, -0.012, 0.006);
  for (const double radius : {0.0, 0.05}) {
    clamp(mooneyRivlinScene(), radius);
    const Equilibrium here = expectDerivativesOfOneEnergy(target);
    EXPECT_EQ(here.stiffness, here.stiffness.transpose());
    EXPECT_LT(here.force.dot(target), 0) << "the tissue pulls the tool back";
    EXPECT_GT(here.energy, 0);
  }
}

/// The patch and the fixed nodes hold all nodes of some elements, whose fibres lock.
TEST_F(TransitionTest, ALargeForceOfTheToolExcusesNoResidualElsewhere) {
  Scene scene = mooneyRivlinScene();
  scene.regions[0].material = {.law = LawName::holzapfel_gasser_ogden,
                               .mu = 3870,
                               .k1 = 20000,
                               .k2 = 40,
                               .fibers = {Eigen::Vector3d::UnitX()}};
  clamp(test::clampedProblem(scene, test::cubeMesh(0.1, 2), {0.05, 0.05, 0.05}, 0.051));
  double largest = 0;
  for (double pulled = 0.002; pulled < 0.03; pulled += 0.002) {
    const Outcome outcome = reach({pulled, 0, 0});
    if (!outcome.converged()) continue;
    largest = std::max(largest, outcome.equilibrium().force.norm());
    EXPECT_LT(outcome.configuration().residual, 1e-3);
  }
  EXPECT_GT(largest, 1e9);
}

TEST_F(TransitionTest, AWeightedToolMatchesItsEnergyAndStartsFromStoredFields) {
  Scene scene = mooneyRivlinScene();
  scene.fixed.groups = {"xmin"};
  scene.active = {
      {.name = "tip", .near = blob_tip, .radius = 0.06, .tool = ToolKind::weighted_average}};
  clamp(resolve(scene, test::blobMesh()));
  const Eigen::Vector3d target(0.008, -0.012, 0.006);
  const Equilibrium here = expectDerivativesOfOneEnergy(target);
  Failure failure;
  const auto start =
      solver_->startFrom(reach(0.5 * target).configuration().fields, 0.5 * target, failure);
  ASSERT_TRUE(start);
  const Outcome restarted = solver_->reach(*start, target).outcome;
  ASSERT_TRUE(restarted.converged());
  EXPECT_LT((restarted.equilibrium().force - here.force).norm(), 1e-8 * here.force.norm());
}

TEST_F(TransitionTest, UnderGravityTheZeroConfigurationIsAnEquilibriumWithoutForce) {
  Scene scene = mooneyRivlinScene();
  scene.regions[0].material.density = 1060;
  scene.gravity = {0, 0, -5};
  clamp(scene);
  const Outcome origin = reach(Eigen::Vector3d::Zero());
  ASSERT_TRUE(origin.converged());
  const Eigen::Vector3d target(0.006, -0.01, 0.004);
  const Equilibrium here = expectDerivativesOfOneEnergy(target);
  EXPECT_LT(origin.equilibrium().force.norm(), 1e-8 * here.force.norm());
  EXPECT_NEAR(origin.equilibrium().energy, 0, 1e-12);
  const std::int32_t tip = problem_.active[0].node;
  EXPECT_LT(origin.configuration().fields.displacement[3 * tip + 2], -1e-3) << "the body sags";
  EXPECT_NEAR(reach(target).configuration().fields.displacement[3 * tip + 2] -
                  origin.configuration().fields.displacement[3 * tip + 2],
              target.z(), 1e-8);
}

TEST_F(TransitionTest, AWeightTooSmallToMoveAnythingLeavesTheRestStateStable) {
  Scene scene = mooneyRivlinScene();
  scene.regions[0].material.density = 1060;
  scene.gravity = {0, 0, -1e-10};
  clamp(scene);
  EXPECT_TRUE(reach({0, 0.01, 0}).converged());
}

TEST_F(TransitionTest, UnderItsWeightEveryElementConverges) {
  Scene scene = mooneyRivlinScene();
  scene.regions[0].material.density = 1060;
  scene.gravity = {0, 0, -9.81};
  scene.discretization.displacement = DisplacementSpace::p2;
  for (const PressureSpace pressure : {PressureSpace::p1, PressureSpace::p2}) {
    scene.discretization.pressure = pressure;
    clamp(scene);
    const Outcome outcome = reach({0.001, 0, 0});
    EXPECT_TRUE(outcome.converged()) << describe(outcome.failure());
  }
}

TEST_F(TransitionTest, ABodyThatCollapsesUnderItsWeightIsReported) {
  Scene scene = mooneyRivlinScene();
  scene.regions[0].material.density = 1060;
  scene.gravity = {0, 0, -3e4};
  problem_ = test::clampedProblem(scene, test::blobMesh(), blob_tip);
  solver_.emplace(problem_, chooseKernels());
  Failure failure;
  EXPECT_FALSE(solver_->startAtRest(failure));
  EXPECT_NE(failure.cause, Cause::none);
}

TEST_F(TransitionTest, AStepTakesFewTangentsForAnyElement) {
  clamp(mooneyRivlinScene());
  int factorizations = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      const Outcome outcome = reach(sign * 0.03 * Eigen::Vector3d::Unit(axis));
      ASSERT_TRUE(outcome.converged()) << describe(outcome.failure());
      factorizations += outcome.cost.factorizations;
    }
  EXPECT_LE(factorizations, 12);
}

TEST_F(TransitionTest, TheZeroConfigurationHasNoForceAndAStiffness) {
  clamp(mooneyRivlinScene());
  const Outcome origin = reach(Eigen::Vector3d::Zero());
  ASSERT_TRUE(origin.converged());
  EXPECT_LT(origin.equilibrium().force.norm(), 1e-12);
  EXPECT_EQ(origin.equilibrium().energy, 0);
  EXPECT_EQ(origin.cost.newton_iterations, 0);
  EXPECT_LT(origin.equilibrium().stiffness.eigenvalues().real().maxCoeff(), 0);
}

TEST_F(TransitionTest, PressureIsPositiveWhereTheToolCompresses) {
  for (const PressureSpace pressure : {PressureSpace::p1_stabilized, PressureSpace::p1}) {
    Scene scene = mooneyRivlinScene();
    scene.discretization.pressure = pressure;
    scene.discretization.displacement =
        pressure == PressureSpace::p1_stabilized ? DisplacementSpace::p1 : DisplacementSpace::p2;
    clamp(scene);
    const auto tip = static_cast<std::size_t>(problem_.active[0].node);
    const Outcome pushed = reach({-0.01, 0, 0}), pulled = reach({0.01, 0, 0});
    ASSERT_TRUE(pushed.converged() && pulled.converged());
    EXPECT_GT(pushed.configuration().fields.pressure[tip], 100) << "Pa";
    EXPECT_LT(pulled.configuration().fields.pressure[tip], -100);
  }
}

TEST_F(TransitionTest, OnePathOrManyStepsEndInTheSameConfiguration) {
  clamp(mooneyRivlinScene());
  const Eigen::Vector3d target(0, 0.04, 0.02);
  const Equilibrium direct = equilibriumAt(target);
  Start at = rest_;
  for (int n = 1; n <= 5; ++n) at = *solver_->reach(at, target * n / 5).end;
  const Equilibrium stepwise = solver_->reach(at, target).outcome.equilibrium();
  EXPECT_LT((direct.force - stepwise.force).norm(), 1e-8 * direct.force.norm());
}

TEST_F(TransitionTest, AReportedArchSnapsThroughToOneForceInAnyNumberOfSteps) {
  PALPATE_REFERENCE_FILE(arch, "cases/numerics/P_arch.toml");
  clamp(loadProblem(arch));
  const Eigen::Vector3d target(0, 0, -0.012);
  const Equilibrium direct = equilibriumAt(target);
  EXPECT_LT(direct.force.norm(), 0.6 * equilibriumAt(target / 3).force.norm()) << "it snaps";
  for (const int steps : {2, 8}) {
    Start at = rest_;
    for (int n = 1; n < steps; ++n) at = *solver_->reach(at, target * n / steps).end;
    const Equilibrium stepwise = solver_->reach(at, target).outcome.equilibrium();
    EXPECT_LT((direct.force - stepwise.force).norm(), 1e-6 * direct.force.norm()) << steps;
  }
}

/// A column of neo-Hookean tissue that stands on zmin, under a tool as wide as its top.
Problem columnUnder(ToolKind tool, const Mesh& mesh) {
  const Eigen::AlignedBox3d box = boundingBox(mesh);
  Scene scene;
  scene.name = "column";
  scene.regions = {{"", {.law = LawName::neo_hookean, .mu = 3000}}};
  scene.discretization = {DisplacementSpace::p2, PressureSpace::p1};
  scene.fixed.groups = {"zmin"};
  scene.active = {{.name = "tip",
                   .near = Eigen::Vector3d(0.005, 0.005, box.max().z()),
                   .radius = 0.0072,
                   .tool = tool}};
  return resolve(scene, mesh);
}

/// A column under a soft tool buckles in two ways at once. If the solver learns to solve it, choose
/// another body.
TEST_F(TransitionTest, ABodyThatBucklesInManyWaysFailsWithItsCause) {
  clamp(columnUnder(ToolKind::weighted_average, test::boxMesh({0.01, 0.01, 0.05}, {2, 2, 6})));
  const Outcome outcome = reach({0, 0, -7e-3});
  ASSERT_FALSE(outcome.converged());
  EXPECT_EQ(outcome.failure().cause, Cause::bifurcation);
  EXPECT_THAT(describe(outcome.failure()), testing::HasSubstr("the body buckles"));
}

/// The critical mode is diagonal, so its components along x and y are equally large, and the first
/// is x. The twin bends to the side of negative x, with the same force.
TEST_F(TransitionTest, OfTwoTwinsTheOneOnThePositiveSideOfTheModeIsUsed) {
  const Mesh column = test::boxMesh({0.01, 0.01, 0.08}, {2, 2, 16});
  Mesh mirrored = column;
  for (Eigen::Vector3d& node : mirrored.nodes) node.x() = 0.01 - node.x();
  finishMesh(mirrored, "a mirrored column");
  for (const Mesh& mesh : {column, mirrored}) {
    clamp(columnUnder(ToolKind::rigid, mesh));
    const Outcome outcome = reach({0, 0, -5e-3});
    ASSERT_TRUE(outcome.converged()) << describe(outcome.failure());
    const auto middle = std::ranges::min_element(problem_.mesh.nodes, {}, [](const auto& x) {
      return (x - Eigen::Vector3d(0.005, 0.005, 0.04)).norm();
    });
    const auto node = static_cast<std::size_t>(middle - problem_.mesh.nodes.begin());
    EXPECT_GT(outcome.configuration().fields.displacement[3 * node], 1e-3);
  }
}

TEST_F(TransitionTest, ASolveGivesTheSameBitsWhateverCameBefore) {
  clamp(mooneyRivlinScene());
  const Eigen::Vector3d target(0.01, 0.02, 0);
  const Outcome first = reach(target);
  reach({-0.01, 0, 0.03});
  reach({0.03, 0, -0.03});
  const Outcome again = reach(target);
  clamp(mooneyRivlinScene());
  const Outcome fresh = reach(target);
  ASSERT_TRUE(first.converged());
  for (const Outcome& other : {again, fresh}) {
    EXPECT_EQ(first.equilibrium().force, other.equilibrium().force);
    EXPECT_EQ(first.equilibrium().stiffness, other.equilibrium().stiffness);
    EXPECT_EQ(first.equilibrium().energy, other.equilibrium().energy);
    EXPECT_EQ(first.configuration().fields.id(), other.configuration().fields.id());
  }
}

TEST_F(TransitionTest, AStartSurvivesItsRoundingToFloat32) {
  clamp(mooneyRivlinScene());
  const Eigen::Vector3d halfway(0.01, 0.01, 0), target(0.02, 0.02, 0);
  const Outcome stored = reach(halfway);
  Failure failure;
  const auto start = solver_->startFrom(stored.configuration().fields, halfway, failure);
  ASSERT_TRUE(start);
  const Outcome reached = solver_->reach(*start, target).outcome;
  ASSERT_TRUE(reached.converged());
  const Equilibrium direct = equilibriumAt(target);
  EXPECT_LT((reached.equilibrium().force - direct.force).norm(), 1e-8 * direct.force.norm());
}

TEST_F(TransitionTest, ThePatchMovesRigidlyAndTheFixedNodesStay) {
  clamp(mooneyRivlinScene(), 0.05);
  const Eigen::Vector3d target(0.01, -0.01, 0.01);
  const Outcome outcome = reach(target);
  ASSERT_TRUE(outcome.converged());
  ASSERT_GT(problem_.active[0].nodes.size(), 1u);
  for (const std::int32_t node : problem_.active[0].nodes)
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(outcome.configuration().fields.displacement[3 * node + i],
                static_cast<float>(target[i]));
  for (const std::int32_t node : problem_.fixed)
    for (int i = 0; i < 3; ++i)
      EXPECT_EQ(outcome.configuration().fields.displacement[3 * node + i], 0.0f);
}

TEST_F(TransitionTest, TheReactionIsTheLagrangeMultiplierOfThePaper) {
  clamp(mooneyRivlinScene());
  const Eigen::Vector3d target(0.004, 0.01, -0.006);
  const Equilibrium eliminated = equilibriumAt(target);

  // The same equations with the tool's displacement a as an unknown and a = p as a constraint with
  // multiplier l (Sec. 3 of the paper): r_f = 0, r_a + l = 0, a - p = 0. l is the force of the
  // tissue on the tool.
  const System& system = solver_->system();
  const int n = system.unknowns();
  State state = system.restState();
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), multiplier = Eigen::Vector3d::Zero();
  for (int iteration = 0; iteration < 20; ++iteration) {
    Residual residual;
    Tangent tangent;
    system.assemble(state, residual, tangent);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + 6, n + 6);
    K.topLeftCorner(n, n) = test::dense(system, tangent);
    K.block(0, n, n, 3) = tangent.tool_coupling;
    K.block(n, 0, 3, n) = tangent.tool_coupling.transpose();
    K.block(n, n, 3, 3) = tangent.tool;
    K.block(n, n + 3, 3, 3) = K.block(n + 3, n, 3, 3) = Eigen::Matrix3d::Identity();
    Eigen::VectorXd r(n + 6);
    r << residual.free, residual.tool + multiplier, a - target;
    const Eigen::VectorXd step = K.partialPivLu().solve(-r);
    a += step.segment<3>(n);
    multiplier += step.tail<3>();
    state = system.moved(state, step.head(n), 1, a);
    if (step.norm() < 1e-13) break;
  }
  EXPECT_LT((multiplier - eliminated.force).norm(), 1e-9 * eliminated.force.norm());
}

TEST_F(TransitionTest, StVenantKirchhoffAndLinearAgreeForSmallDisplacements) {
  const Eigen::Vector3d target(0, 1e-6, 0);
  clamp(youngScene(LawName::linear));
  const Eigen::Vector3d linear = equilibriumAt(target).force;
  clamp(youngScene(LawName::st_venant_kirchhoff));
  EXPECT_LT((equilibriumAt(target).force - linear).norm(), 1e-3 * linear.norm());
}

TEST_F(TransitionTest, UnreachableTargetsFailWithACauseWithinTheBudget) {
  Scene scene = youngScene(LawName::st_venant_kirchhoff, 0.49);
  clamp(test::clampedProblem(scene, test::blobMesh(), blob_tip));
  const Outcome outcome = reach({-0.15, 0, 0});
  ASSERT_FALSE(outcome.converged());
  EXPECT_NE(outcome.failure().cause, Cause::none);
  EXPECT_GE(outcome.failure().element, 0);
  EXPECT_LT(outcome.failure().step_reached, 1);
  EXPECT_LE(outcome.cost.factorizations, TransitionOptions{}.max_factorizations + 1);
}

TEST_F(TransitionTest, AConvergedStateWithAnInvertedElementIsRefusedUnlessTheSceneAllowsIt) {
  Scene scene = youngScene(LawName::linear);
  const Eigen::Vector3d through_the_body(-0.15, 0, 0);
  clamp(test::clampedProblem(scene, test::blobMesh(), blob_tip));
  const Outcome refused = reach(through_the_body);
  ASSERT_FALSE(refused.converged());
  EXPECT_EQ(refused.failure().cause, Cause::inverted_element);
  EXPECT_LE(refused.failure().element_det_F, 0);
  scene.workspace.reject_inverted = false;
  clamp(test::clampedProblem(scene, test::blobMesh(), blob_tip));
  const Outcome allowed = reach(through_the_body);
  ASSERT_TRUE(allowed.converged());
  EXPECT_LT(allowed.equilibrium().min_det_F, 0);
}

TEST_F(TransitionTest, AForceOfZeroHasNoSign) {
  clamp(test::clampedProblem(youngScene(LawName::linear), test::blobMesh(), blob_tip));
  const Eigen::Vector3d force = equilibriumAt(Eigen::Vector3d::Zero()).force;
  EXPECT_EQ(force, Eigen::Vector3d::Zero());
  for (const double component : force) EXPECT_FALSE(std::signbit(component));
}

TEST_F(TransitionTest, ADisplacementThatOverflowsIsReportedAsNotFinite) {
  clamp(mooneyRivlinScene());
  const Reached nowhere = solver_->reach(rest_, {1e300, 0, 0});
  EXPECT_EQ(nowhere.outcome.failure().cause, Cause::not_finite);
  EXPECT_FALSE(nowhere.end) << "there is no state to continue from";
}

TEST_F(TransitionTest, AnExhaustedNewtonNamesTheSpentBudget) {
  TransitionOptions options;
  options.newton.max_iterations = 1;
  options.smallest_step = 0.6;
  clamp(test::clampedProblem(mooneyRivlinScene(), test::blobMesh(), blob_tip), options);
  EXPECT_EQ(reach({0.05, 0.05, 0}).failure().cause, Cause::iteration_limit);
  options.smallest_step = 1e-9;
  options.max_factorizations = 3;
  clamp(test::clampedProblem(mooneyRivlinScene(), test::blobMesh(), blob_tip), options);
  EXPECT_EQ(reach({0.05, 0.05, 0}).failure().cause, Cause::step_budget);
}

TEST_F(TransitionTest, TaylorHoodConvergesWhereWholeElementsAreFixed) {
  Scene scene = mooneyRivlinScene();
  scene.discretization.displacement = DisplacementSpace::p2;
  scene.discretization.pressure = PressureSpace::p1;
  scene.fixed.half_spaces = {{0, true, 0.6, std::nullopt}};
  scene.active = {{.name = "tip", .near = blob_tip}};
  clamp(resolve(scene, test::blobMesh()));
  const Outcome outcome = reach({0, 0.01, 0});
  ASSERT_TRUE(outcome.converged()) << describe(outcome.failure());
  EXPECT_EQ(outcome.configuration().fields.pressure.size(),
            static_cast<std::size_t>(problem_.mesh.vertices()));
}

/// Pressures of elements that move as a whole have no equation and stay unchanged.
TEST_F(TransitionTest, ConvergesWhereTheToolHoldsWholeElements) {
  Scene scene = mooneyRivlinScene();
  scene.fixed.groups = {"xmin"};
  scene.active = {{.name = "tip", .near = Eigen::Vector3d(0.1, 0.05, 0.05), .radius = 0.06}};
  const Eigen::Vector3d target(0.002, -0.003, 0.001);
  for (const Discretization& element : test::everyElement()) {
    scene.discretization = element;
    scene.regions[0].material.bulk.reset();
    if (element.pressure == PressureSpace::none) scene.regions[0].material.bulk = 40000;
    clamp(resolve(scene, test::cubeMesh(0.1, 4)));
    EXPECT_LT(reach(Eigen::Vector3d::Zero()).equilibrium().force.norm(), 1e-9);
    // The other elements have singular tangents for other reasons, so only their start is tested.
    if (!isInfSupStable(element)) continue;
    SCOPED_TRACE(test::nameOf(element));
    expectDerivativesOfOneEnergy(target, 1e-5);
  }
}

TEST_F(TransitionTest, EqualOrderPressureConvergesAlthoughItsTangentIsSingular) {
  Scene scene = mooneyRivlinScene();
  scene.discretization.pressure = PressureSpace::p1;
  scene.discretization.constraint = Constraint::det_F_minus_1;
  clamp(scene);
  EXPECT_FALSE(solver_->system().expectedNegativePivots());
  const Equilibrium here = equilibriumAt({0, 0.01, 0});
  EXPECT_TRUE(here.force.allFinite());
}

/// The scheduler uses this time to detect hung solves.
TEST_F(TransitionTest, TheTimeOfASolveExcludesASuspendedProcess) {
  clamp(mooneyRivlinScene());
  std::atomic<bool> over = false;
  std::jthread stops_us([&] {
    test::runCommand(
        fmt::format("sleep 0.1; kill -STOP {0}; sleep 2; kill -CONT {0}; sleep 0.1", getpid()));
    over = true;
  });
  double longest = 0;
  while (!over) longest = std::max(longest, reach({0, 0.01, 0}).cost.seconds);
  EXPECT_GT(longest, 0);
  EXPECT_LT(longest, 1);
}

}  // namespace
}  // namespace palpate
