// A box with distorted elements, pulled or sheared so that its strain is the same everywhere: any
// element must find that state and its stress to rounding (patch test).
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "worker/verification/box_mesh.hpp"
#include "worker/verification/case.hpp"
#include "worker/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double edge = 0.1;  ///< metres
constexpr double tolerance = 1e-9;

/// A component of the mean nominal stress, or a combination, and what it should be.
struct Expected {
  std::string name;
  std::function<double(const Eigen::Matrix3d& P)> measured;
  double stress;  ///< Pa
};

/// A node group and the axes along which it is held.
using Held = std::pair<std::string, std::string>;

struct Homogeneous {
  std::string name;
  Eigen::Matrix3d F;
  std::vector<Held> held;  ///< where F puts them
  std::vector<Expected> expected;
};

const std::vector<Held> symmetry = {{"xmin", "x"}, {"ymin", "y"}, {"zmin", "z"}, {"xmax", "x"}};

Expected pullAlongX(double stress) {
  return {"", [](const Eigen::Matrix3d& P) { return P(0, 0); }, stress};
}

Eigen::Matrix3d stretches(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z).asDiagonal();
}

/// Pulled along x, with these stretches across, which are kept on `more` sides.
Homogeneous pulled(const char* name, double l, double y, double z, double stress,
                   const std::vector<Held>& more) {
  Homogeneous state = {
      fmt::format("{} {}", name, l), stretches(l, y, z), symmetry, {pullAlongX(stress)}};
  state.held.insert(state.held.end(), more.begin(), more.end());
  return state;
}

/// Pulled along x, free across: of an incompressible body, or of one with this lateral stretch.
Homogeneous uniaxial(double l, double stress, double lateral) {
  return pulled("uniaxial", l, lateral, lateral, stress, {});
}
Homogeneous uniaxial(double l, double stress) { return uniaxial(l, stress, 1 / std::sqrt(l)); }

/// Pulled along x and y alike, free along z.
Homogeneous equibiaxial(double l, double stress) {
  return pulled("equibiaxial", l, l, 1 / (l * l), stress, {{"ymax", "y"}});
}

/// Pulled along x, kept along y, free along z.
Homogeneous pureShear(double l, double stress) {
  return pulled("pure shear", l, 1, 1 / l, stress, {{"ymax", "y"}});
}

/// Pulled along x, kept across.
Homogeneous uniaxialStrain(double l, double stress) {
  return pulled("uniaxial strain", l, 1, 1, stress, {{"ymax", "y"}, {"zmax", "z"}});
}

/// Sheared by k in the plane of x and y, no stress along z. J = 1, so the Cauchy stress is P F^T.
Homogeneous simpleShear(double k, double mu, double c01) {
  Homogeneous state;
  state.name = fmt::format("simple shear {}", k);
  state.F << 1, k, 0, 0, 1, 0, 0, 0, 1;
  for (const char* side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    state.held.push_back({side, "xy"});
  state.held.push_back({"zmin", "z"});
  const auto cauchy = [F = state.F](const Eigen::Matrix3d& P, int i, int j) {
    return (P * F.transpose())(i, j);
  };
  state.expected = {
      {" s12", [=](const Eigen::Matrix3d& P) { return cauchy(P, 0, 1); }, mu * k},
      {" s11-s22", [=](const Eigen::Matrix3d& P) { return cauchy(P, 0, 0) - cauchy(P, 1, 1); },
       mu * k * k},
      {" s22-s33", [=](const Eigen::Matrix3d& P) { return cauchy(P, 1, 1) - cauchy(P, 2, 2); },
       0.0 - 2 * c01 * k * k}};
  return state;
}

/// The exact state with the free components off by up to 1 % of an element.
State disturbed(const Rig& rig, const Eigen::Matrix3d& F) {
  const BodyModel& body = rig.body();
  State state = rig.system().restState();
  std::mt19937 random(7);
  for (std::size_t node = 0; node < body.mesh.nodes.size(); ++node) {
    const Eigen::Vector3d u = (F - Eigen::Matrix3d::Identity()) * body.mesh.nodes[node];
    for (std::size_t i = 0; i < 3; ++i) {
      const double off = 0.01 * edge / 3 * (2.0 * random() / 4294967295.0 - 1);
      state.u[3 * node + i] = u[static_cast<int>(i)] + (body.fixed[3 * node + i] ? 0 : off);
    }
  }
  return state;
}

double farthestFrom(const Eigen::Matrix3d& F, const Mesh& mesh, const State& state) {
  double farthest = 0;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node) {
    const Eigen::Vector3d exact = (F - Eigen::Matrix3d::Identity()) * mesh.nodes[node];
    farthest =
        std::max(farthest, (displacementOf(state, static_cast<std::int32_t>(node)) - exact).norm());
  }
  return farthest;
}

std::vector<Row> rowsOfStates(const std::string& material_name, const Material& material,
                              const Discretization& discretization,
                              const std::vector<Homogeneous>& states) {
  std::vector<Row> rows;
  double farthest = 0;
  for (const Homogeneous& state : states) {
    BodyModel body = bodyOf(distortedBoxMesh(Eigen::Vector3d::Constant(edge), {3, 3, 3}),
                            discretization, material);
    for (const auto& [group, axes] : state.held) hold(body, group, axes);
    Rig rig(body);
    const NewtonResult result = rig.equilibrium(disturbed(rig, state.F));
    const Eigen::Matrix3d P = meanStress(body, result.state);
    for (const Expected& expected : state.expected)
      rows.push_back({fmt::format("{}, {}{}", material_name, state.name, expected.name),
                      expected.measured(P), expected.stress, tolerance, "Pa"});
    farthest = std::max(farthest, farthestFrom(state.F, body.mesh, result.state));
  }
  rows.push_back({material_name + ", farthest node / edge", farthest / edge, 0, tolerance});
  return rows;
}

/// Nominal stresses of an incompressible isotropic body, W1 and W2 the derivatives of W by the
/// invariants (Rivlin 1948).
using Slopes = std::function<std::pair<double, double>(double I1)>;

double uniaxialStress(double l, const Slopes& slopes) {
  const auto [w1, w2] = slopes(l * l + 2 / l);
  return 2 * (l - 1 / (l * l)) * (w1 + w2 / l);
}
double equibiaxialStress(double l, const Slopes& slopes) {
  const auto [w1, w2] = slopes(2 * l * l + std::pow(l, -4));
  return 2 * (l - std::pow(l, -5)) * (w1 + w2 * l * l);
}
double pureShearStress(double l, const Slopes& slopes) {
  const auto [w1, w2] = slopes(l * l + 1 + 1 / (l * l));
  return 2 * (l - std::pow(l, -3)) * (w1 + w2);
}

/// The states of a law of the invariants.
std::vector<Homogeneous> statesOf(const Slopes& slopes) {
  std::vector<Homogeneous> states;
  for (const double l : {0.8, 1.5}) states.push_back(uniaxial(l, uniaxialStress(l, slopes)));
  states.push_back(equibiaxial(1.2, equibiaxialStress(1.2, slopes)));
  states.push_back(pureShear(1.5, pureShearStress(1.5, slopes)));
  return states;
}

std::vector<Row> mooneyRivlinRows(const std::string& element,
                                  const Discretization& discretization) {
  const Material material = mooneyRivlin();
  std::vector<Homogeneous> states = statesOf([](double) { return std::pair{1300.0, 1280.0}; });
  states.push_back(simpleShear(0.5, shearModulus(material), material.c01));
  return rowsOfStates("Mooney-Rivlin " + element, material, discretization, states);
}

std::vector<Row> neoHookeanRows() {
  constexpr double mu = 5160;
  std::vector<Homogeneous> states = statesOf([](double) { return std::pair{mu / 2, 0.0}; });
  states.push_back(simpleShear(0.5, mu, 0));
  // P = dW/dl of W(l) = mu/2 (l^(-2/3) (l^2 + 2) - 3) + U(l).
  Material compressible = neoHookean(mu);
  constexpr double bulk = 20000, l = 0.8;
  compressible.bulk = bulk;
  const double stress =
      mu / 2 * (4.0 / 3 * std::cbrt(l) - 4.0 / 3 * std::pow(l, -5.0 / 3)) + bulk / 2 * (l - 1 / l);
  return joined({rowsOfStates("neo-Hookean", neoHookean(mu), taylor_hood, states),
                 rowsOfStates("neo-Hookean, bulk", compressible, p2_displacement,
                              {uniaxialStrain(l, stress)})});
}

std::vector<Row> yeohRows() {
  Material material;
  material.law = LawName::yeoh;
  material.c10 = 2580;
  material.c20 = -300;
  material.c30 = 150;
  return rowsOfStates(
      "Yeoh", material, taylor_hood, statesOf([&](double I1) {
        const double x = I1 - 3;
        return std::pair{material.c10 + 2 * material.c20 * x + 3 * material.c30 * x * x, 0.0};
      }));
}

std::vector<Row> verondaWestmannRows() {
  Material material;
  material.law = LawName::veronda_westmann;
  material.c1 = 1000;
  material.c2 = 2;
  return rowsOfStates("Veronda-Westmann", material, taylor_hood, statesOf([&](double I1) {
                        const double c = material.c1 * material.c2;
                        return std::pair{c * std::exp(material.c2 * (I1 - 3)), -c / 2};
                      }));
}

/// P = sum of mu (l^(alpha - 1) - l^(e alpha - 1)), where l^e is the stretch of the free sides.
std::vector<Row> ogdenRows() {
  Material material;
  material.law = LawName::ogden;
  material.ogden = {
      {6300, 1.3}, {12, 5.0}, {-100, -2.0}};  // Ogden 1972, rubber, in units of 0.01 kg/cm^2
  const auto stress = [&](double l, double e) {
    double sum = 0;
    for (const auto& [mu, alpha] : material.ogden)
      sum += mu * (std::pow(l, alpha - 1) - std::pow(l, e * alpha - 1));
    return sum;
  };
  return rowsOfStates("Ogden", material, taylor_hood,
                      {uniaxial(0.8, stress(0.8, -0.5)), uniaxial(1.5, stress(1.5, -0.5)),
                       equibiaxial(1.2, stress(1.2, -2)), pureShear(1.5, stress(1.5, -1))});
}

/// One family along the pull, so that both sides shrink alike.
std::vector<Row> holzapfelGasserOgdenRows() {
  Material material;
  material.law = LawName::holzapfel_gasser_ogden;
  material.mu = 5160;
  material.k1 = 4000;
  material.k2 = 0.8;
  material.dispersion = 0.1;
  material.fibers = {Eigen::Vector3d::UnitX()};
  const auto stress = [&](double l) {
    const double kappa = material.dispersion;
    const double E = kappa * (l * l + 2 / l - 3) + (1 - 3 * kappa) * (l * l - 1);
    const double dE = kappa * (2 * l - 2 / (l * l)) + (1 - 3 * kappa) * 2 * l;
    return material.mu * (l - 1 / (l * l)) + material.k1 * E * std::exp(material.k2 * E * E) * dE;
  };
  return rowsOfStates("HGO along the fibre", material, taylor_hood,
                      {uniaxial(1.1, stress(1.1)), uniaxial(1.3, stress(1.3))});
}

std::vector<Row> stVenantKirchhoffRows() {
  constexpr double young = 15480, nu = 0.3;
  std::vector<Homogeneous> states;
  for (const double l : {0.8, 1.2})
    states.push_back(uniaxial(l, young / 2 * l * (l * l - 1), std::sqrt(1 - nu * (l * l - 1))));
  return rowsOfStates("St. Venant-Kirchhoff", stVenantKirchhoff(young, nu), p2_displacement,
                      states);
}

/// P = dW/dl of W(l), W = lambda/2 (tr g)^2 + mu g:g with the lateral stretch l^(-1/2).
double modifiedStress(double l, double lambda, double mu) {
  const double trace = (l * l + 2 / l - 3) / 2;
  return lambda * trace * (l - 1 / (l * l)) + mu * (l * (l * l - 1) - (1 / l - 1) / (l * l));
}

std::vector<Row> modifiedStVenantKirchhoffRows() {
  constexpr double young = 15480, nu = 0.49;
  Material kept = stVenantKirchhoff(young, nu);
  kept.law = LawName::modified_st_venant_kirchhoff;
  Material dropped = kept;
  dropped.poisson.reset();
  const auto rowsWith = [](const char* name, const Material& material, double lambda, double mu) {
    return rowsOfStates(name, material, stabilized,
                        {uniaxial(0.8, modifiedStress(0.8, lambda, mu)),
                         uniaxial(1.2, modifiedStress(1.2, lambda, mu))});
  };
  return joined({rowsWith("modified SVK, lambda kept", kept, young * nu / ((1 + nu) * (1 - 2 * nu)),
                          young / (2 * (1 + nu))),
                 rowsWith("modified SVK, lambda = 0", dropped, 0, young / 3)});
}

}  // namespace

std::vector<Case> homogeneousCases() {
  return {
      {"homogeneous-mooney-rivlin-p1-stabilized", false,
       [] { return mooneyRivlinRows("P1-stabilized", stabilized); }},
      {"homogeneous-mooney-rivlin-p2-p1", false,
       [] { return mooneyRivlinRows("P2/P1", taylor_hood); }},
      {"homogeneous-mooney-rivlin-p1-p1", false,
       [] { return mooneyRivlinRows("P1/P1", equal_order); }},
      {"homogeneous-neo-hookean", false, neoHookeanRows},
      {"homogeneous-yeoh", false, yeohRows},
      {"homogeneous-ogden", false, ogdenRows},
      {"homogeneous-veronda-westmann", false, verondaWestmannRows},
      {"homogeneous-holzapfel-gasser-ogden", false, holzapfelGasserOgdenRows},
      {"homogeneous-st-venant-kirchhoff", false, stVenantKirchhoffRows},
      {"homogeneous-modified-st-venant-kirchhoff", false, modifiedStVenantKirchhoffRows},
  };
}

}  // namespace palpate::verification
