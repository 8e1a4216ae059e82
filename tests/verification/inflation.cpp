// A hollow sphere, and a tube in plane strain, whose inner wall is pushed outwards. The pressure is
// computed as the work of the wall's reaction forces per change of the hollow's volume. Rivlin and
// Ogden give closed forms for Mooney-Rivlin.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

using std::numbers::pi;
using tissue::c01, tissue::c10;

constexpr double inner = 0.01, outer = 0.02, thickness = 0.005;  ///< metres
constexpr double stretch = 1.5;                                  ///< hoop stretch of the inner wall

double exactSphere() {
  const double a = stretch, ratio = inner / outer;
  const double b = std::cbrt(1 + (a * a * a - 1) * ratio * ratio * ratio);
  return c10 * (4 / b + std::pow(b, -4) - 4 / a - std::pow(a, -4)) +
         c01 * (4 * (a - b) - 2 * (1 / (a * a) - 1 / (b * b)));
}

double exactTube() {
  const double a = stretch, ratio = inner / outer;
  const double b = std::sqrt(1 + (a * a - 1) * ratio * ratio);
  return 2 * (c10 + c01) * (std::log(a / b) - (1 / (a * a) - 1 / (b * b)) / 2);
}

/// Returns the pressure that keeps the nodes of `wall` at `stretch` times their rest position.
///
/// `radial` has a 1 for each coordinate that grows. Their number d is 3 for a sphere and 2 for a
/// tube. `hollow` is the volume of the hollow at rest; its derivative with respect to the stretch
/// is d stretch^(d-1) hollow. Newton starts from r^d = R^d + const, which preserves volumes.
double pressure(BodyModel body, const std::string& wall, const Eigen::Vector3d& radial,
                double hollow) {
  const double d = radial.sum(), growth = (std::pow(stretch, d) - 1) * std::pow(inner, d);
  hold(body, wall, "xyz");
  Rig rig(body);
  State state = displaced(rig.system(), [&](const Eigen::Vector3d& from) {
    const Eigen::Vector3d X = from.cwiseProduct(radial);
    const double r = std::pow(std::pow(X.norm(), d) + growth, 1 / d);
    return Eigen::Vector3d((r / X.norm() - 1) * X);
  });
  const auto& nodes = body.mesh.node_groups.at(wall);
  for (const std::int32_t node : nodes)
    ofNode(state.u, node) = (stretch - 1) * body.mesh.nodes[node].cwiseProduct(radial);
  state = rig.equilibrium(std::move(state)).state;

  const NodalForces forces = nodalForces(body, state);
  double work = 0;  // work of the wall's reaction forces per unit of stretch
  for (const std::int32_t node : nodes)
    work += forces.row(node).dot(body.mesh.nodes[node].cwiseProduct(radial));
  return work / (d * std::pow(stretch, d - 1) * hollow);
}

double spherePressure(const Discretization& discretization, int n) {
  BodyModel octant = bodyOf(sphereOctantMesh(inner, outer, n), discretization, mooneyRivlin());
  holdSymmetryPlanes(octant);
  return pressure(std::move(octant), "first", {1, 1, 1}, pi / 6 * inner * inner * inner);
}

double tubePressure(int n) {
  BodyModel quarter =
      bodyOf(quarterTubeMesh(inner, outer, thickness, n), taylor_hood, mooneyRivlin());
  holdSymmetryPlanes(quarter);
  hold(quarter, "last", "z");
  return pressure(std::move(quarter), "inner", {1, 1, 0}, pi / 4 * inner * inner * thickness);
}

std::vector<Row> sphereRows(const std::string& element, const Discretization& discretization,
                            int n) {
  return rowsOfSecondOrder(fmt::format("sphere {}, n = {} to {}: pressure", element, n, 2 * n),
                           spherePressure(discretization, n), spherePressure(discretization, 2 * n),
                           exactSphere(), "Pa");
}

std::vector<Row> tubeRows(int n) {
  return rowsOfSecondOrder(fmt::format("tube P2/P1, n = {} to {}: pressure", n, 2 * n),
                           tubePressure(n), tubePressure(2 * n), exactTube(), "Pa");
}

}  // namespace

std::vector<Case> inflationCases() {
  return {{"sphere-inflation", false, [] { return sphereRows("P2/P1", taylor_hood, 4); }},
          {"tube-inflation", false, [] { return tubeRows(4); }},
          {"inflation-fine", true, [] {
             return joined({sphereRows("P2/P1", taylor_hood, 6),
                            sphereRows("P1-stabilized", stabilized, 8), tubeRows(12)});
           }}};
}

}  // namespace palpate::verification
