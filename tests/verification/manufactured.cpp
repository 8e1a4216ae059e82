// Manufactured solutions. A displacement is chosen, and the load that makes it an equilibrium is
// computed from the law. The L2 error of the solution must fall with the square (P1) or the cube
// (P2) of the element size.
#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "tests/verification/quadrature.hpp"
#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

/// The chosen displacement on the unit cube is u_i = a sin(k_i . X + phase_i), where k_i is row i
/// of `waves`. Its strains reach 0.2 and vary everywhere.
constexpr double amplitude = 0.05;
const Eigen::Matrix3d waves =
    (Eigen::Matrix3d() << 2.0, 1.5, -1.0, -1.2, 2.2, 1.6, 1.4, -0.9, 2.4).finished();
const Eigen::Vector3d phases(0.3, 1.1, 2.0);

Eigen::Vector3d exactDisplacement(const Eigen::Vector3d& X) {
  return amplitude * (waves * X + phases).array().sin();
}
Eigen::Matrix3d exactF(const Eigen::Vector3d& X) {
  const Eigen::Vector3d slope = amplitude * (waves * X + phases).array().cos();
  return Eigen::Matrix3d::Identity() + slope.asDiagonal() * waves;
}

/// First Piola-Kirchhoff stress P = F S, Pa, programmed independently of the kernels.
using Stress = Eigen::Matrix3d (*)(const Eigen::Matrix3d& F);

Eigen::Matrix3d stVenantKirchhoffStress(const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity(), g = (F.transpose() * F - I) / 2;
  using tissue::young, tissue::poisson;
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
               shear = young / (2 * (1 + poisson));
  return F * (lambda * g.trace() * I + 2 * shear * g);
}

/// W = mu/2 (J^(-2/3) I1 - 3) + bulk/4 (J^2 - 1 - 2 ln J).
Eigen::Matrix3d neoHookeanStress(const Eigen::Matrix3d& F) {
  const double J = F.determinant();
  const Eigen::Matrix3d F_inverse_T = F.inverse().transpose();
  return tissue::mu * std::pow(J, -2.0 / 3) * (F - F.squaredNorm() / 3 * F_inverse_T) +
         tissue::bulk / 2 * (J * J - 1) * F_inverse_T;
}

/// Returns the nodal loads of the body force -Div P. On inner nodes this is the integral of P :
/// grad N, because N vanishes on the boundary. All nodes on the boundary are held, so their loads
/// do no work.
std::vector<double> loadOf(const Mesh& mesh, Stress stress) {
  std::vector<double> load(3 * mesh.nodes.size(), 0.0);
  integrate(mesh, [&](const IntegrationPoint& point) {
    const Eigen::Matrix3d P = stress(exactF(point.X));
    for (int a = 0; a < point.nodes; ++a)
      ofNode(load, point.node[a]) += point.weight * (P * point.gradient[a]);
  });
  return load;
}

double l2Error(const Mesh& mesh, const State& state) {
  double sum = 0;
  integrate(mesh, [&](const IntegrationPoint& point) {
    Eigen::Vector3d u = Eigen::Vector3d::Zero();
    for (int a = 0; a < point.nodes; ++a) u += point.N[a] * ofNode(state.u, point.node[a]);
    sum += point.weight * (u - exactDisplacement(point.X)).squaredNorm();
  });
  return std::sqrt(sum);
}

struct Law {
  std::string name;
  Material material;
  Stress stress;
};
const Law st_venant_kirchhoff = {"St. Venant-Kirchhoff", stVenantKirchhoff(),
                                 stVenantKirchhoffStress};
const Law compressible_neo_hookean = {"compressible neo-Hookean",
                                      neoHookean(tissue::mu, tissue::bulk), neoHookeanStress};

double solvedError(const Discretization& discretization, const Law& law, int n) {
  BodyModel body = bodyOf(cubeMesh(1, n), discretization, law.material);
  for (const char* side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) hold(body, side, "xyz");
  body.load = loadOf(body.mesh, law.stress);
  Rig rig(body);
  return l2Error(body.mesh, rig.equilibrium(displaced(rig.system(), exactDisplacement)).state);
}

Row order(const Law& law, const Discretization& discretization, int n) {
  const bool quadratic = discretization.displacement == DisplacementSpace::p2;
  const double coarse = solvedError(discretization, law, n);
  const double fine = solvedError(discretization, law, 2 * n);
  return {
      fmt::format("{} {}, n = {} to {}: order in L2", law.name, quadratic ? "P2" : "P1", n, 2 * n),
      orderOf(coarse, fine), quadratic ? 3.0 : 2.0, 0.05};
}

}  // namespace

std::vector<Case> manufacturedCases() {
  return {{"manufactured-solution", false,
           [] {
             return std::vector{order(st_venant_kirchhoff, p1_displacement, 4),
                                order(st_venant_kirchhoff, p2_displacement, 3),
                                order(compressible_neo_hookean, p1_displacement, 4),
                                order(compressible_neo_hookean, p2_displacement, 3)};
           }},
          {"manufactured-solution-fine", true, [] {
             return std::vector{order(compressible_neo_hookean, p1_displacement, 8),
                                order(compressible_neo_hookean, p2_displacement, 5)};
           }}};
}

}  // namespace palpate::verification
