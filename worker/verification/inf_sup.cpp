// The discrete inf-sup constant: the square root of the smallest eigenvalue of B A^-1 B^T q =
// beta^2 M q, with A the H1 seminorm of displacements, M the mass of pressures, and B from the
// tangent of the system itself. Unit cube, clamped at the bottom (Chapelle and Bathe 1993).
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "worker/elements/kernel_family.hpp"
#include "worker/verification/box_mesh.hpp"
#include "worker/verification/case.hpp"
#include "worker/verification/quadrature.hpp"
#include "worker/verification/rig.hpp"

namespace palpate::verification {
namespace {

struct InfSup {
  int zero_modes;  ///< pressures that no displacement feels
  double beta;     ///< smallest of the others
};

/// B, one row per pressure: what is left of the integral of p div v per component of the nodes,
/// zero where they are held.
std::array<Eigen::MatrixXd, 3> coupling(const System& system, Eigen::Index nodes,
                                        Eigen::Index pressures) {
  struct Place {
    Eigen::Index index = -1;
    int component = -1;  ///< 3: a pressure
  };
  std::vector<Place> place_of(system.unknowns());
  const State number = numbering(system);
  for (Eigen::Index node = 0; node < nodes; ++node)
    for (int i = 0; i < 3; ++i)
      if (const double k = number.u[3 * node + i]; k > 0) place_of[std::lround(k) - 1] = {node, i};
  for (Eigen::Index node = 0; node < pressures; ++node)
    place_of[std::lround(number.q[node]) - 1] = {node, 3};

  Residual residual;
  Tangent tangent;
  system.assemble(system.restState(), residual, tangent);
  std::array<Eigen::MatrixXd, 3> B;
  B.fill(Eigen::MatrixXd::Zero(pressures, nodes));
  const SparsityPattern& pattern = system.pattern();
  for (std::size_t entry = 0; entry < pattern.row.size(); ++entry) {
    Place a = place_of[pattern.row[entry] - 1], b = place_of[pattern.column[entry] - 1];
    if (b.component == 3) std::swap(a, b);
    if (a.component == 3 && b.component < 3)
      B[b.component](a.index, b.index) = tangent.values[entry] / system.pressureScale();
  }
  return B;
}

InfSup infSup(const Discretization& discretization, int n) {
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
  InfSup result{0, 0};
  while (eigen.eigenvalues()[result.zero_modes] < zero) ++result.zero_modes;
  result.beta = std::sqrt(eigen.eigenvalues()[result.zero_modes]);
  return result;
}

/// Published with three digits, on the same meshes.
std::vector<Row> rowsOf(const char* element, const Discretization& discretization, int n,
                        int zero_modes, double beta) {
  const InfSup found = infSup(discretization, n);
  return {{fmt::format("{}, n = {}: inf-sup constant", element, n), found.beta, beta, 0.01},
          {fmt::format("{}, n = {}: spurious pressure modes", element, n),
           static_cast<double>(found.zero_modes), static_cast<double>(zero_modes), 0}};
}
std::vector<Row> stable(int n, double beta) { return rowsOf("P2/P1", taylor_hood, n, 0, beta); }
std::vector<Row> unstable(int n, double beta) {
  return rowsOf("P1/P1 (unstable)", equal_order, n, 3, beta);
}

std::vector<Row> quickRows() {
  return joined({stable(2, 0.565), stable(3, 0.562), stable(4, 0.561), unstable(2, 0.148),
                 unstable(3, 0.113), unstable(4, 0.084)});
}

std::vector<Row> longRows() { return joined({stable(6, 0.561), unstable(6, 0.059)}); }

}  // namespace

std::vector<Case> infSupCases() {
  return {{"inf-sup", false, quickRows}, {"inf-sup-fine", true, longRows}};
}

}  // namespace palpate::verification
