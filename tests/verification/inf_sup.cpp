// The discrete inf-sup constant beta. beta^2 is the smallest non-zero eigenvalue of the problem B
// A^-1 B^T q = beta^2 M q. A is the H1 seminorm of displacements, M the mass matrix of pressures,
// and B is taken from the system's tangent. The body is a unit cube, clamped at the bottom
// (Chapelle and Bathe 1993).
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "tests/verification/quadrature.hpp"
#include "tests/verification/rig.hpp"
#include "worker/elements/kernel_family.hpp"

namespace palpate::verification {
namespace {

/// Returns B as one matrix per displacement component, with one row per pressure and one column per
/// node. Entries are integrals of p div v, and zero at held nodes.
std::array<Eigen::MatrixXd, 3> coupling(const System& system, Eigen::Index nodes,
                                        Eigen::Index pressures) {
  std::vector<Dof> dof_of(system.unknowns());
  const auto note = [&](const Dof& place) {
    if (const std::int32_t k = system.numbers().at(place); k >= 0) dof_of[k] = place;
  };
  for (std::int32_t node = 0; node < nodes; ++node)
    for (int i = 0; i < 3; ++i) note({node, i});
  for (std::int32_t slot = 0; slot < pressures; ++slot) note({slot, pressure_component});

  Residual residual;
  Tangent tangent;
  system.assemble(system.restState(), residual, tangent);
  std::array<Eigen::MatrixXd, 3> B;
  B.fill(Eigen::MatrixXd::Zero(pressures, nodes));
  const SparsityPattern& pattern = system.pattern();
  for (std::size_t entry = 0; entry < pattern.row.size(); ++entry) {
    Dof a = dof_of[pattern.row[entry] - 1], b = dof_of[pattern.column[entry] - 1];
    if (b.component == pressure_component) std::swap(a, b);
    if (a.component == pressure_component && b.component != pressure_component)
      B[b.component](a.node, b.node) = tangent.values[entry] / system.pressureScale();
  }
  return B;
}

/// Returns a row for the constant beta, and a row for the number of pressure modes that have no
/// effect on any displacement. The references were published for the same meshes, with three
/// digits.
std::vector<Row> infSupRows(const char* element, const Discretization& discretization, int n,
                            int zero_modes, double beta) {
  BodyModel body = bodyOf(cubeMesh(1, n), discretization, mooneyRivlin());
  hold(body, "zmin", "xyz");
  const System system(body, chooseKernels());
  const auto nodes = static_cast<Eigen::Index>(body.mesh.nodes.size());
  const auto pressures = static_cast<Eigen::Index>(system.restState().q.size());

  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(nodes, nodes),
                  M = Eigen::MatrixXd::Zero(pressures, pressures);
  integrate(body.mesh, [&](const IntegrationPoint& point) {
    for (int a = 0; a < point.nodes; ++a)
      for (int b = 0; b < point.nodes; ++b)
        A(point.node[a], point.node[b]) += point.weight * point.gradient[a].dot(point.gradient[b]);
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < 4; ++b)
        M(point.node[a], point.node[b]) += point.weight * point.vertex_N[a] * point.vertex_N[b];
  });
  for (const std::int32_t node : body.mesh.node_groups.at("zmin")) {
    A.row(node).setZero();
    A.col(node).setZero();
    A(node, node) = 1;
  }
  const Eigen::LLT<Eigen::MatrixXd> cholesky(A);
  Eigen::MatrixXd S = Eigen::MatrixXd::Zero(pressures, pressures);
  for (const Eigen::MatrixXd& B : coupling(system, nodes, pressures))
    S += B * cholesky.solve(B.transpose());
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(S, M,
                                                                        Eigen::EigenvaluesOnly);
  constexpr double zero = 1e-10;  // the largest eigenvalue is about 1
  const auto zeros = (eigen.eigenvalues().array() < zero).count();
  return {{fmt::format("{}, n = {}: inf-sup constant", element, n),
           std::sqrt(eigen.eigenvalues()[zeros]), beta, 0.01},
          {fmt::format("{}, n = {}: spurious pressure modes", element, n), double(zeros),
           double(zero_modes), 0}};
}
std::vector<Row> stable(int n, double beta) { return infSupRows("P2/P1", taylor_hood, n, 0, beta); }
std::vector<Row> unstable(int n, double beta) {
  return infSupRows("P1/P1 (unstable)", equal_order, n, 3, beta);
}

}  // namespace

std::vector<Case> infSupCases() {
  return {{"inf-sup", false,
           [] {
             return joined({stable(2, 0.565), stable(3, 0.562), stable(4, 0.561),
                            unstable(2, 0.148), unstable(3, 0.113), unstable(4, 0.084)});
           }},
          {"inf-sup-fine", true, [] {
             return joined({stable(6, 0.561), unstable(6, 0.059)});
           }}};
}

}  // namespace palpate::verification
