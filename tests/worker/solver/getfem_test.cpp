// Forces against GetFEM, the finite-element library of the 2010 paper, run as a program of its own:
// it shares nothing with this project, neither the elements nor the elimination of what is held (it
// uses multipliers).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/command.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/problems.hpp"
#include "tests/support/reference_data.hpp"
#include "tests/support/reference_liver.hpp"
#include "tests/support/temporary_directory.hpp"
#include "worker/solver/transition.hpp"

namespace palpate {
namespace {

using test::liverProblem;
using test::mooneyRivlinScene;
using test::youngScene;

struct GetfemCase {
  std::string name, law;  ///< law: GetFEM's side, an argument of getfem_reference.py
  Scene scene;
  Eigen::Vector3d target;  ///< metres, reached in three steps
};

std::ostream& operator<<(std::ostream& out, const GetfemCase& c) { return out << c.name; }

Scene equalOrder(Scene scene) {
  scene.discretization.pressure = PressureSpace::p1;
  return scene;
}

/// The St. Venant-Kirchhoff laws have the paper's poisson = 0.49, so lambda is 49 times mu and
/// GetFEM's line search creeps: 28 to 38 iterations a step, however short the step. Their ways are
/// shorter to keep the test quick. GetFEM's default residual is tight enough: forces agree to
/// better than 1e-9.
std::vector<GetfemCase> cases() {
  return {
      {"Linear", "linear", youngScene(LawName::linear, 0.49), {0.01, 0.02, -0.02}},
      {"StVenantKirchhoff",
       "svk",
       youngScene(LawName::st_venant_kirchhoff, 0.49),
       {0.009, 0.006, 0.009}},
      {"ModifiedStVenantKirchhoff",
       "msvk",
       equalOrder(youngScene(LawName::modified_st_venant_kirchhoff, 0.49)),
       {0.006, -0.01, 0.008}},
      {"MooneyRivlin", "mr", equalOrder(mooneyRivlinScene()), {0.03, 0, 0}},
      {"MooneyRivlinAcross", "mr", equalOrder(mooneyRivlinScene()), {0.01, 0.02, 0.02}},
  };
}

/// What GetFEM found at a third, two thirds and the whole of the way.
struct GetfemStep {
  Eigen::Vector3d displacement, force;
  bool converged;
};

std::vector<GetfemStep> runGetfem(const std::string& law, const Eigen::Vector3d& active,
                                  const Eigen::Vector3d& target, int n_steps,
                                  const std::filesystem::path& program,
                                  const std::filesystem::path& mesh,
                                  const std::string& options = "") {
  const auto run = test::runCommand(
      fmt::format("/usr/bin/python3 '{}' '{}' --law {} --fixed-below x 0.15 --active {} {} {} "
                  "--to {} {} {} --steps {} {}",
                  program.string(), mesh.string(), law, active[0], active[1], active[2], target[0],
                  target[1], target[2], n_steps, options));
  if (run.exit_code != 0)
    throw failure("{} ended with {} (is the package python3-getfem installed?):\n{}",
                  program.string(), run.exit_code, run.output);
  const auto vector = [](const nlohmann::json& json) {
    return Eigen::Vector3d(json.at(0), json.at(1), json.at(2));
  };
  const nlohmann::json answer = nlohmann::json::parse(run.output);
  std::vector<GetfemStep> steps;
  for (const auto& step : answer.at("steps"))
    steps.push_back(
        {vector(step.at("displacement")), vector(step.at("force_on_tool")), step.at("converged")});
  return steps;
}

/// Follows GetFEM's steps from rest and expects its forces.
void expectSameForces(const Problem& problem, const std::vector<GetfemStep>& steps) {
  TransitionSolver solver(problem, chooseKernels());
  Failure failure;
  const auto rest = solver.startAtRest(failure);
  ASSERT_TRUE(rest) << describe(failure);
  Start at = *rest;
  for (const GetfemStep& step : steps) {
    ASSERT_TRUE(step.converged) << "GetFEM at " << step.displacement.transpose();
    const Reached reached = solver.reach(at, step.displacement);
    ASSERT_TRUE(reached.outcome.converged()) << describe(reached.outcome.failure());
    const Eigen::Vector3d force = reached.outcome.equilibrium().force;
    EXPECT_LT((force - step.force).norm(), 1e-6 * step.force.norm())
        << "ours " << force.transpose() << ", GetFEM's " << step.force.transpose();
    at = *reached.end;
  }
}

/// The nodes that the program selects: fixed in the lowest 15 % of x, the vertex nearest to
/// `active` and what is within the radius of it; middles of edges are nodes too.
void selectAsGetfem(Problem& problem, const Eigen::Vector3d& active, double radius) {
  const std::vector<Eigen::Vector3d>& nodes = problem.mesh.nodes;
  const auto along_x = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return a[0] < b[0];
  };
  const auto [low, high] = std::minmax_element(nodes.begin(), nodes.end(), along_x);
  const double plane = (*low)[0] + 0.15 * ((*high)[0] - (*low)[0]);
  const auto nearest = std::min_element(
      nodes.begin(), nodes.begin() + problem.mesh.vertices(), [&](const auto& a, const auto& b) {
        return (a - active).squaredNorm() < (b - active).squaredNorm();
      });
  ActivePatch patch;
  patch.node = static_cast<std::int32_t>(nearest - nodes.begin());
  for (std::int32_t node = 0; node < static_cast<std::int32_t>(nodes.size()); ++node) {
    if (nodes[node][0] < plane) {
      problem.fixed.push_back(node);
    } else if ((nodes[node] - *nearest).norm() <= std::max(radius, 1e-12)) {
      patch.nodes.push_back(node);
    }
  }
  problem.active = {patch};
}

class Getfem : public ::testing::TestWithParam<GetfemCase> {};

TEST_P(Getfem, FindsTheSameForces) {
  PALPATE_REFERENCE_FILE(mesh, "meshes/liver-493.msh");
  PALPATE_REFERENCE_FILE(program, "oracle/getfem_reference.py");
  Scene scene = GetParam().scene;
  scene.discretization.constraint = Constraint::det_F_minus_1;
  const std::vector<GetfemStep> steps =
      runGetfem(GetParam().law, test::liver_tip, GetParam().target, 3, program, mesh);
  ASSERT_EQ(steps.size(), 3u);
  expectSameForces(liverProblem(scene, mesh), steps);
}

INSTANTIATE_TEST_SUITE_P(Laws, Getfem, ::testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.name; });

/// Taylor-Hood elements, on an organ made in code: on the liver GetFEM takes half a minute.
TEST(GetfemTaylorHood, FindsTheSameForcesOfANodeAndOfAPatch) {
  PALPATE_REFERENCE_FILE(program, "oracle/getfem_reference.py");
  const test::TemporaryDirectory directory;
  Mesh linear = test::blobMesh();
  linear.node_groups.clear();  // GetFEM takes their points for elements
  test::writeGmsh22(linear, directory / "blob.msh");
  const Eigen::Vector3d side(0.1, 0, 0.02), target(0.008, 0.004, -0.006);
  for (const double radius : {0.0, 0.03}) {
    Problem problem;
    problem.scene = mooneyRivlinScene();
    problem.scene.discretization = {DisplacementSpace::p2, PressureSpace::p1,
                                    Constraint::det_F_minus_1};
    problem.mesh = linear;
    addMidEdgeNodes(problem.mesh);
    problem.region_of.assign(problem.mesh.tetrahedra.size(), 0);
    selectAsGetfem(problem, side, radius);
    EXPECT_EQ(problem.active[0].nodes.size() > 1, radius > 0);
    expectSameForces(problem,
                     runGetfem("mr", problem.mesh.nodes[problem.active[0].node], target, 1, program,
                               directory / "blob.msh",
                               fmt::format("--order 2 --pressure-order 1 --patch {}", radius)));
  }
}

/// Mooney-Rivlin on liver-493, the tip pulled along x.
class Liver : public ::testing::Test {
 protected:
  Outcome pulled(const Discretization& discretization, double metres) {
    Scene scene = mooneyRivlinScene();
    scene.discretization = discretization;
    const Problem problem = liverProblem(scene, test::referenceData("meshes/liver-493.msh"));
    TransitionSolver solver(problem, chooseKernels());
    Failure failure;
    const auto rest = solver.startAtRest(failure);
    if (!rest) throw palpate::failure("{}", describe(failure));
    return solver.reach(*rest, {metres, 0, 0}).outcome;
  }
  double force(PressureSpace pressure, Constraint constraint, double metres) {
    const Outcome outcome = pulled({.pressure = pressure, .constraint = constraint}, metres);
    EXPECT_TRUE(outcome.converged()) << describe(outcome.failure());
    return outcome.equilibrium().force.norm();
  }
  /// Largest pressure, Pa. A tip that is pulled lowers the pressure under it, so this should stay
  /// small.
  double highestPressure(PressureSpace pressure, double metres) {
    const auto p = pulled({.pressure = pressure, .constraint = Constraint::det_F_minus_1}, metres)
                       .configuration()
                       .fields.pressure;
    return *std::max_element(p.begin(), p.end());
  }
};

TEST_F(Liver, IsStifferWithTheEqualOrderPressureThanWithItsStabilisation) {
  PALPATE_REFERENCE_FILE(mesh, "meshes/liver-493.msh");
  const double unstable = force(PressureSpace::p1, Constraint::det_F_minus_1, 0.01);
  const double stabilized = force(PressureSpace::p1_stabilized, Constraint::det_F_minus_1, 0.01);
  EXPECT_NEAR(unstable, 0.604, 0.001);
  EXPECT_NEAR(stabilized, 0.503, 0.001);
}

TEST_F(Liver, HasAPressureThatOscillatesWithoutStabilisation) {
  PALPATE_REFERENCE_FILE(mesh, "meshes/liver-493.msh");
  EXPECT_GT(highestPressure(PressureSpace::p1, 0.01), 3000);
  EXPECT_LT(highestPressure(PressureSpace::p1_stabilized, 0.01), 300);
}

TEST_F(Liver, FeelsAlmostTheSameUnderEitherFormOfTheConstraint) {
  PALPATE_REFERENCE_FILE(mesh, "meshes/liver-493.msh");
  for (const PressureSpace pressure : {PressureSpace::p1, PressureSpace::p1_stabilized})
    for (const auto& [metres, tolerance] : {std::pair(0.001, 0.005), std::pair(0.01, 0.05)}) {
      const double determinant = force(pressure, Constraint::det_F_minus_1, metres);
      const double logarithm = force(pressure, Constraint::ln_det_F, metres);
      EXPECT_NEAR(logarithm, determinant, tolerance * determinant);
      EXPECT_NE(logarithm, determinant);
    }
}

TEST_F(Liver, HasNoPressureAtRestBecauseMooneyRivlinIsIsochoric) {
  PALPATE_REFERENCE_FILE(mesh, "meshes/liver-493.msh");
  // Written in I1 and I2 themselves the law would need 2 C10 + 4 C01 = 7.72 kPa to be at rest.
  for (const PressureSpace pressure : {PressureSpace::p1, PressureSpace::p1_stabilized}) {
    const Outcome rest = pulled({.pressure = pressure, .constraint = Constraint::det_F_minus_1}, 0);
    ASSERT_TRUE(rest.converged());
    EXPECT_EQ(rest.cost.newton_iterations, 0);
    for (const float p : rest.configuration().fields.pressure) EXPECT_EQ(p, 0);
  }
}

}  // namespace
}  // namespace palpate
