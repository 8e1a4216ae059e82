// A displacement is chosen, the load that makes it an equilibrium computed from the law, and the
// solution compared with it: the L2 error must fall with the square of the element size (P1) or its
// cube (P2).
#include <fmt/format.h>

#include <Eigen/LU>
#include <cmath>

#include "worker/verification/box_mesh.hpp"
#include "worker/verification/case.hpp"
#include "worker/verification/quadrature.hpp"
#include "worker/verification/rig.hpp"

namespace palpate::verification {
namespace {

/// u_i = a sin(k_i . X + phase_i) on the unit cube: strains of up to 0.2, curved everywhere.
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

/// First Piola-Kirchhoff stress P = F S, Pa, written anew here.
using Stress = Eigen::Matrix3d (*)(const Eigen::Matrix3d& F);

constexpr double young = 15480, poisson = 0.3, mu = 5160, bulk = 20000;

Eigen::Matrix3d stVenantKirchhoffStress(const Eigen::Matrix3d& F) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity(), g = (F.transpose() * F - I) / 2;
  const double lambda = young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
               shear = young / (2 * (1 + poisson));
  return F * (lambda * g.trace() * I + 2 * shear * g);
}

/// W = mu/2 (J^(-2/3) I1 - 3) + bulk/4 (J^2 - 1 - 2 ln J).
Eigen::Matrix3d neoHookeanStress(const Eigen::Matrix3d& F) {
  const double J = F.determinant();
  const Eigen::Matrix3d F_inverse_T = F.inverse().transpose();
  return mu * std::pow(J, -2.0 / 3) * (F - F.squaredNorm() / 3 * F_inverse_T) +
         bulk / 2 * (J * J - 1) * F_inverse_T;
}

/// The load of the body force -Div P, on the nodes inside: integral of P : grad N, because N
/// vanishes on the boundary. On the boundary, where everything is held, a load has no work to do.
std::vector<double> loadOf(const Mesh& mesh, Stress stress) {
  std::vector<double> load(3 * mesh.nodes.size(), 0.0);
  integrate(mesh, [&](const IntegrationPoint& point) {
    const Eigen::Matrix3d P = stress(exactF(point.X));
    for (int a = 0; a < point.nodes; ++a)
      Eigen::Map<Eigen::Vector3d>(&load[3 * static_cast<std::size_t>(point.node[a])]) +=
          point.weight * (P * point.gradient[a]);
  });
  return load;
}

double l2Error(const Mesh& mesh, const State& state) {
  double sum = 0;
  integrate(mesh, [&](const IntegrationPoint& point) {
    Eigen::Vector3d u = Eigen::Vector3d::Zero();
    for (int a = 0; a < point.nodes; ++a) u += point.N[a] * displacementOf(state, point.node[a]);
    sum += point.weight * (u - exactDisplacement(point.X)).squaredNorm();
  });
  return std::sqrt(sum);
}

double solvedError(const Discretization& discretization, const Material& material, Stress stress,
                   int n) {
  BodyModel body = bodyOf(cubeMesh(1, n), discretization, material);
  for (const char* side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"}) hold(body, side, "xyz");
  body.load = loadOf(body.mesh, stress);
  Rig rig(body);
  return l2Error(body.mesh, rig.equilibrium(displaced(rig.system(), exactDisplacement)).state);
}

Row order(const std::string& name, const Discretization& discretization, const Material& material,
          Stress stress, int n) {
  const bool quadratic = discretization.displacement == DisplacementSpace::p2;
  const double coarse = solvedError(discretization, material, stress, n);
  const double fine = solvedError(discretization, material, stress, 2 * n);
  return {fmt::format("{} {}, n = {} to {}: order in L2", name, quadratic ? "P2" : "P1", n, 2 * n),
          orderOf(coarse, fine), quadratic ? 3.0 : 2.0, 0.05};
}

Row stVenantKirchhoffOrder(const Discretization& discretization, int n) {
  return order("St. Venant-Kirchhoff", discretization, stVenantKirchhoff(young, poisson),
               stVenantKirchhoffStress, n);
}

Row neoHookeanOrder(const Discretization& discretization, int n) {
  Material compressible = neoHookean(mu);
  compressible.bulk = bulk;
  return order("compressible neo-Hookean", discretization, compressible, neoHookeanStress, n);
}

std::vector<Row> quickRows() {
  return {stVenantKirchhoffOrder(p1_displacement, 4), stVenantKirchhoffOrder(p2_displacement, 3),
          neoHookeanOrder(p1_displacement, 4), neoHookeanOrder(p2_displacement, 3)};
}

std::vector<Row> longRows() {
  return {neoHookeanOrder(p1_displacement, 8), neoHookeanOrder(p2_displacement, 5)};
}

}  // namespace

std::vector<Case> manufacturedCases() {
  return {{"manufactured-solution", false, quickRows},
          {"manufactured-solution-fine", true, longRows}};
}

}  // namespace palpate::verification
