// What a tool feels: minus the gradient of the stored energy, with a symmetric derivative, and the Lagrange
// multiplier of the paper.
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/box_mesh.hpp"
#include "worker/verification/case.hpp"
#include "worker/verification/rig.hpp"

namespace palpate::verification {
namespace {

/// A clamped box whose far corner edge is the tool.
BodyModel clampedBox() {
  BodyModel body = bodyOf(distortedBoxMesh({0.15, 0.1, 0.1}, {3, 2, 2}), stabilized, mooneyRivlin());
  hold(body, "xmin", "xyz");
  Tool tool;
  for (const std::int32_t node : nodesInPlane(body.mesh, 0, 0.15))
    if (body.mesh.nodes[node][2] > 0.1 - 1e-9) tool.nodes.push_back(node);
  body.tools = {tool};
  return body;
}

const Eigen::Vector3d place(0.012, -0.02, 0.015);  ///< of the tool, metres

/// The equilibrium with the tool at `p`, from rest.
NewtonResult withToolAt(Rig& rig, const Eigen::Vector3d& p) {
  const System& system = rig.system();
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(system.unknowns());
  State state = system.restState();
  constexpr int steps = 4;
  NewtonResult result;
  for (int step = 1; step <= steps; ++step) {
    const Eigen::Vector3d at = p * step / steps;
    result = rig.equilibrium(system.moved(state, nothing, 1, at), at);
    state = result.state;
  }
  return result;
}

/// -(K_aa + K_af S), K_ff S = -K_fa.
Eigen::Matrix3d stiffness(Rig& rig, const Tangent& tangent) {
  Eigen::MatrixXd S = -tangent.tool_coupling;
  if (!rig.solver().factorize(tangent.values).ok || !rig.solver().solve(S))
    throw std::runtime_error("no factorisation");
  return -(tangent.tool + tangent.tool_coupling.transpose() * S);
}

/// The tissue's force with the tool's displacement an unknown a and a = p a constraint with a multiplier l:
/// r_f = 0, r_a + l = 0, a - p = 0.
Eigen::Vector3d multiplier(const Rig& rig) {
  const System& system = rig.system();
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

std::vector<Row> rows() {
  Rig rig(clampedBox());
  constexpr double h = 1e-5;  // metres
  const NewtonResult here = withToolAt(rig, place);
  const Eigen::Vector3d force = -here.residual.tool;
  const Eigen::Matrix3d H = stiffness(rig, here.tangent);
  Eigen::Vector3d gradient;
  Eigen::Matrix3d differences;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d e = h * Eigen::Vector3d::Unit(i);
    const NewtonResult up = withToolAt(rig, place + e), down = withToolAt(rig, place - e);
    gradient[i] = (up.residual.energy - down.residual.energy) / (2 * h);
    differences.col(i) = (down.residual.tool - up.residual.tool) / (2 * h);
  }
  return {
      {"force + gradient of the energy, relative", (force + gradient).norm() / force.norm(), 0, 1e-6},
      {"dh/dp, asymmetry, relative", (H - H.transpose()).norm() / H.norm(), 0, 1e-10},
      {"dh/dp against differences of h, relative", (H - differences).norm() / H.norm(), 0, 1e-6},
      {"force against the multiplier, relative", (force - multiplier(rig)).norm() / force.norm(), 0, 1e-9}};
}

}  // namespace

std::vector<Case> reactionCases() {
  return {{"force-and-stiffness", false, rows}};
}

}  // namespace palpate::verification
