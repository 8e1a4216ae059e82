// Checks that the force on a tool is minus the gradient of the stored energy, that its derivative
// is symmetric, and that it equals a Lagrange multiplier, as in Peterlik et al. (2010).
#include <Eigen/LU>
#include <algorithm>

#include "common/base/error.hpp"
#include "tests/verification/rig.hpp"
#include "worker/solver/transition.hpp"

namespace palpate::verification {
namespace {

/// Returns a clamped box with its upper far edge as the tool.
Problem clampedBox() {
  Scene scene;
  scene.name = "clamped box";
  scene.regions[0].material = mooneyRivlin();
  scene.fixed.groups = {"xmin"};
  scene.active = {{.name = "edge", .near = Eigen::Vector3d(0.15, 0.05, 0.1), .radius = 0.05}};
  return resolve(std::move(scene), distortedBoxMesh({0.15, 0.1, 0.1}, {3, 2, 2}));
}

const Eigen::Vector3d place(0.012, -0.02, 0.015);  ///< of the tool, metres

/// Returns the tissue's force on the tool, computed as a Lagrange multiplier l. The tool's
/// displacement is an unknown a that is constrained to p: r_f = 0, r_a + l = 0, a - p = 0.
Eigen::Vector3d multiplier(const System& system) {
  const int n = system.unknowns();
  State state = system.restState();
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), l = Eigen::Vector3d::Zero();
  for (int step = 1; step <= 20; ++step) {
    const Eigen::Vector3d p = place * std::min(1.0, step / 4.0);
    Residual residual;
    Tangent tangent;
    system.assemble(state, residual, tangent);
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + 6, n + 6);
    for (std::size_t entry = 0; entry < tangent.values.size(); ++entry) {
      const int row = system.pattern().row[entry] - 1, column = system.pattern().column[entry] - 1;
      K(row, column) = K(column, row) = tangent.values[entry];
    }
    K.block(0, n, n, 3) = tangent.tool_coupling;
    K.block(n, 0, 3, n) = tangent.tool_coupling.transpose();
    K.block(n, n, 3, 3) = tangent.tool;
    K.block(n, n + 3, 3, 3) = K.block(n + 3, n, 3, 3) = Eigen::Matrix3d::Identity();
    Eigen::VectorXd r(n + 6);
    r << residual.free, residual.tool + l, a - p;
    const Eigen::VectorXd move = K.partialPivLu().solve(-r);
    a += move.segment<3>(n);
    l += move.tail<3>();
    state = system.moved(state, move.head(n), 1, a);
    if (step > 4 && move.norm() < 1e-13) break;
  }
  return l;
}

std::vector<Row> reactionRows() {
  const Problem problem = clampedBox();
  TransitionSolver solver(problem, chooseKernels());
  Failure why_no_rest;
  const std::optional<Start> rest = solver.startAtRest(why_no_rest);
  if (!rest) throw failure("no rest state: {}", describe(why_no_rest));
  // Each equilibrium starts from rest, as in a worker.
  const auto equilibriumAt = [&](const Eigen::Vector3d& p) {
    const Outcome outcome = solver.reach(*rest, p).outcome;
    if (!outcome.converged()) throw failure("no equilibrium: {}", describe(outcome.failure()));
    return outcome.equilibrium();
  };
  constexpr double h = 1e-5;  // metres
  const Equilibrium here = equilibriumAt(place);
  Eigen::Vector3d gradient;
  Eigen::Matrix3d differences;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
    const Equilibrium up = equilibriumAt(place + e), down = equilibriumAt(place - e);
    gradient[i] = (up.energy - down.energy) / (2 * h);
    differences.col(i) = (up.force - down.force) / (2 * h);
  }
  const double force = here.force.norm(), stiffness = here.stiffness.norm();
  return {
      {"force + gradient of the energy, relative", (here.force + gradient).norm() / force, 0, 1e-6},
      {"asymmetry of the finite-difference stiffness, relative",
       (differences - differences.transpose()).norm() / stiffness, 0, 1e-6},
      {"stiffness minus its finite difference, relative",
       (here.stiffness - differences).norm() / stiffness, 0, 1e-6},
      {"force minus the Lagrange multiplier, relative",
       (here.force - multiplier(solver.system())).norm() / force, 0, 1e-8}};
}

}  // namespace

std::vector<Case> reactionCases() { return {{"force-and-stiffness", false, reactionRows}}; }

}  // namespace palpate::verification
