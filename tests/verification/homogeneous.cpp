// A box with distorted elements, pulled or sheared to a uniform strain. Every kind of element must
// find this uniform state and its stress to round-off (patch test).
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double edge = 0.1;  ///< metres
constexpr double tolerance = 1e-9;

/// The expected value of a stress component, or of a combination of stress components.
struct Expected {
  std::string name;
  double (*measured)(const Eigen::Matrix3d& P, const Eigen::Matrix3d& cauchy);
  double stress;  ///< Pa
};

/// A node group and the axes along which it is held.
using Held = std::pair<std::string, std::string>;

struct Homogeneous {
  std::string name;
  Eigen::Matrix3d F;
  std::vector<Held> held;  ///< node groups that are held at the positions given by F
  std::vector<Expected> expected;
};

/// A box pulled along x, with these lateral stretches. In addition to the symmetry planes and the
/// pulled side, the sides in `held` are held at their final positions.
Homogeneous pulled(const char* name, double l, double y, double z, double stress,
                   std::vector<Held> held = {}) {
  held.insert(held.end(), {{"xmin", "x"}, {"ymin", "y"}, {"zmin", "z"}, {"xmax", "x"}});
  return {fmt::format("{} {}", name, l),
          Eigen::Vector3d(l, y, z).asDiagonal().toDenseMatrix(),
          std::move(held),
          {{"", [](const auto& P, const auto&) { return P(0, 0); }, stress}}};
}

/// A box pulled along x, with free sides that get this lateral stretch.
Homogeneous uniaxial(double l, double stress, double lateral) {
  return pulled("uniaxial", l, lateral, lateral, stress);
}
Homogeneous uniaxial(double l, double stress) { return uniaxial(l, stress, 1 / std::sqrt(l)); }

/// A box sheared by k in the plane of x and y, with no stress along z.
Homogeneous simpleShear(double k, double mu, double c01) {
  Homogeneous state;
  state.name = fmt::format("simple shear {}", k);
  state.F << 1, k, 0, 0, 1, 0, 0, 0, 1;
  for (const char* side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    state.held.push_back({side, "xy"});
  state.held.push_back({"zmin", "z"});
  state.expected = {
      {" s12", [](const auto&, const auto& s) { return s(0, 1); }, mu * k},
      {" s11-s22", [](const auto&, const auto& s) { return s(0, 0) - s(1, 1); }, mu * k * k},
      {" s22-s33", [](const auto&, const auto& s) { return s(1, 1) - s(2, 2); },
       0.0 - 2 * c01 * k * k}};
  return state;
}

/// Returns this state with the free components changed by up to 1 % of an element.
State disturbed(State state, const BodyModel& body) {
  std::mt19937 random(7);
  for (std::size_t component = 0; component < state.u.size(); ++component) {
    // A number is drawn for held components too, so that the disturbance of one component does not
    // depend on which others are held.
    const double off = 0.01 * edge / 3 * (2.0 * random() / 4294967295.0 - 1);
    if (!body.fixed[component]) state.u[component] += off;
  }
  return state;
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
    const State exact = displaced(rig.system(), [&](const Eigen::Vector3d& X) -> Eigen::Vector3d {
      return (state.F - Eigen::Matrix3d::Identity()) * X;
    });
    const State found = rig.equilibrium(disturbed(exact, body)).state;
    const Eigen::Matrix3d P = meanStress(body, found);
    const Eigen::Matrix3d cauchy = P * state.F.transpose() / state.F.determinant();
    for (const Expected& expected : state.expected)
      rows.push_back({fmt::format("{}, {}{}", material_name, state.name, expected.name),
                      expected.measured(P, cauchy), expected.stress, tolerance, "Pa"});
    for (std::size_t node = 0; node < body.mesh.nodes.size(); ++node)
      farthest = std::max(farthest, (ofNode(found.u, node) - ofNode(exact.u, node)).norm());
  }
  rows.push_back({material_name + ", farthest node / edge", farthest / edge, 0, tolerance});
  return rows;
}

/// Nominal stress along x of an incompressible body that is free along z. Its stretches are l along
/// x, y along y, and 1/(l y) along z.
using StressAlongX = std::function<double(double l, double y)>;

/// Returns the stress of an isotropic law (Rivlin 1948). `slopes` gives the derivatives of the
/// law's energy with respect to I1 and I2, as functions of I1.
StressAlongX stressBy(const std::function<std::pair<double, double>(double I1)>& slopes) {
  return [slopes](double l, double y) {
    const double z = 1 / (l * y);
    const auto [w1, w2] = slopes(l * l + y * y + z * z);
    return 2 * (l - z * z / l) * (w1 + w2 * y * y);
  };
}

/// Returns states of three kinds: with free sides, pulled equally along x and y, and held along y.
std::vector<Homogeneous> statesOf(const StressAlongX& stress) {
  const auto free = [&](double l) { return uniaxial(l, stress(l, 1 / std::sqrt(l))); };
  const auto held = [&](const char* name, double l, double y) {
    return pulled(name, l, y, 1 / (l * y), stress(l, y), {{"ymax", "y"}});
  };
  return {free(0.8), free(1.5), held("equibiaxial", 1.2, 1.2), held("pure shear", 1.5, 1)};
}

std::vector<Row> mooneyRivlinRows(const std::string& element,
                                  const Discretization& discretization) {
  using tissue::c01, tissue::c10;
  const Material material = mooneyRivlin();
  std::vector<Homogeneous> states = statesOf(stressBy([](double) { return std::pair{c10, c01}; }));
  states.push_back(simpleShear(0.5, shearModulus(material), c01));
  return rowsOfStates("Mooney-Rivlin " + element, material, discretization, states);
}

std::vector<Row> neoHookeanRows() {
  using tissue::bulk, tissue::mu;
  std::vector<Homogeneous> states = statesOf(stressBy([](double) {
    return std::pair{mu / 2, 0.0};
  }));
  states.push_back(simpleShear(0.5, mu, 0));
  // If the sides are held, P = dW/dl with W(l) = mu/2 (l^(-2/3) (l^2 + 2) - 3) + U(l).
  constexpr double l = 0.8;
  const double stress =
      mu / 2 * (4.0 / 3 * std::cbrt(l) - 4.0 / 3 * std::pow(l, -5.0 / 3)) + bulk / 2 * (l - 1 / l);
  return joined(
      {rowsOfStates("neo-Hookean", neoHookean(mu), taylor_hood, states),
       rowsOfStates("neo-Hookean, bulk", neoHookean(mu, bulk), p2_displacement,
                    {pulled("uniaxial strain", l, 1, 1, stress, {{"ymax", "y"}, {"zmax", "z"}})})});
}

std::vector<Row> yeohRows() {
  constexpr double c10 = 2580, c20 = -300, c30 = 150;
  const auto slopes = [](double I1) {
    const double x = I1 - 3;
    return std::pair{c10 + 2 * c20 * x + 3 * c30 * x * x, 0.0};
  };
  return rowsOfStates("Yeoh", {.law = LawName::yeoh, .c10 = c10, .c20 = c20, .c30 = c30},
                      taylor_hood, statesOf(stressBy(slopes)));
}

std::vector<Row> verondaWestmannRows() {
  constexpr double c1 = 1000, c2 = 2, c = c1 * c2;
  const auto slopes = [](double I1) { return std::pair{c * std::exp(c2 * (I1 - 3)), -c / 2}; };
  return rowsOfStates("Veronda-Westmann", {.law = LawName::veronda_westmann, .c1 = c1, .c2 = c2},
                      taylor_hood, statesOf(stressBy(slopes)));
}

/// Ogden's law gives P = sum of mu (l^alpha - z^alpha)/l, with z the stretch of the free sides.
std::vector<Row> ogdenRows() {
  // Ogden 1972, rubber, in units of 0.01 kg/cm^2.
  const std::vector<OgdenTerm> terms = {{6300, 1.3}, {12, 5.0}, {-100, -2.0}};
  const auto stress = [&](double l, double y) {
    double sum = 0;
    for (const auto& [mu, alpha] : terms)
      sum += mu * (std::pow(l, alpha) - std::pow(l * y, -alpha)) / l;
    return sum;
  };
  return rowsOfStates("Ogden", {.law = LawName::ogden, .ogden = terms}, taylor_hood,
                      statesOf(stress));
}

/// There is one fibre family, along the pull, so that both lateral directions contract equally.
std::vector<Row> holzapfelGasserOgdenRows() {
  constexpr double mu = tissue::mu, k1 = 4000, k2 = 0.8, kappa = 0.1;
  const auto state = [](double l) {
    const double E = kappa * (l * l + 2 / l - 3) + (1 - 3 * kappa) * (l * l - 1);
    const double dE = kappa * (2 * l - 2 / (l * l)) + (1 - 3 * kappa) * 2 * l;
    return uniaxial(l, mu * (l - 1 / (l * l)) + k1 * E * std::exp(k2 * E * E) * dE);
  };
  return rowsOfStates("HGO along the fibre",
                      {.law = LawName::holzapfel_gasser_ogden,
                       .mu = mu,
                       .k1 = k1,
                       .k2 = k2,
                       .dispersion = kappa,
                       .fibers = {Eigen::Vector3d::UnitX()}},
                      taylor_hood, {state(1.1), state(1.3)});
}

std::vector<Row> stVenantKirchhoffRows() {
  const auto state = [](double l) {
    return uniaxial(l, tissue::young / 2 * l * (l * l - 1),
                    std::sqrt(1 - tissue::poisson * (l * l - 1)));
  };
  return rowsOfStates("St. Venant-Kirchhoff", stVenantKirchhoff(), p2_displacement,
                      {state(0.8), state(1.2)});
}

/// Returns the nominal stress P = dW/dl, Pa, with W(l) = lambda/2 (tr g)^2 + mu g:g and the lateral
/// stretch l^(-1/2).
double modifiedStress(double l, double lambda, double mu) {
  const double trace = (l * l + 2 / l - 3) / 2;
  return lambda * trace * (l - 1 / (l * l)) + mu * (l * (l * l - 1) - (1 / l - 1) / (l * l));
}

std::vector<Row> modifiedStVenantKirchhoffRows() {
  constexpr double young = tissue::young, nu = 0.49;
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
