// Cook's membrane: a tapered plate, clamped at the left edge and sheared at the right edge. It is
// one layer of tetrahedra that cannot move along z, so it is in plane strain.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double mm = 1e-3, newton_per_mm2 = 1e6;
constexpr double thickness_of_plate = 1 * mm;
constexpr double mu_of_plate = 80.1938 * newton_per_mm2;

std::size_t nodeAt(const Mesh& mesh, const Eigen::Vector3d& X) {
  const auto distance = [&](const Eigen::Vector3d& node) { return (node - X).norm(); };
  return std::ranges::min_element(mesh.nodes, {}, distance) - mesh.nodes.begin();
}

/// Returns the upward displacement, mm, of the tip at (48, 60) mm. `force` is in N per mm of
/// thickness.
double tipDisplacement(const Discretization& discretization, const Material& material, double force,
                       int n) {
  BodyModel body = bodyOf(cookMesh(n, thickness_of_plate), discretization, material);
  hold(body, nodesInPlane(body.mesh, 0, 0), "xyz");
  hold(body, "first", "z");
  hold(body, "last", "z");
  const auto right_edge = facesWhere(
      body.mesh, [](const Eigen::Vector3d& X) { return std::abs(X[0] - 48 * mm) < 1e-9; });
  addTraction(body, right_edge, {0, force / 16 * newton_per_mm2, 0});
  const NewtonResult result = Rig(body).loadInSteps(4);
  return ofNode(result.state.u, nodeAt(body.mesh, {48 * mm, 60 * mm, 0}))[1] / mm;
}

Row incompressible(int n, double reference, double tolerance) {
  return {fmt::format("incompressible neo-Hookean P2/P1, n = {}: tip", n),
          tipDisplacement(taylor_hood, neoHookean(mu_of_plate), 100, n), reference, tolerance,
          "mm"};
}

/// Compares with the data of deal.II's tutorial.
Row compressible(int n, double tolerance) {
  constexpr double shear = 0.4225 * newton_per_mm2, poisson = 0.3;
  const Material material = neoHookean(shear, 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson)));
  return {fmt::format("compressible neo-Hookean P2, n = {}: tip", n),
          tipDisplacement(p2_displacement, material, 1, n), 13.772, tolerance, "mm"};
}

/// In plane strain with J = 1 both invariants are equal, so both laws give the same result.
Row equalLaws(int n, double tolerance) {
  const Material shared = mooneyRivlin(0.3 * mu_of_plate / 2, 0.7 * mu_of_plate / 2);
  return {fmt::format("Mooney-Rivlin (reference: neo-Hookean) P2/P1, n = {}: tip", n),
          tipDisplacement(taylor_hood, shared, 100, n),
          tipDisplacement(taylor_hood, neoHookean(mu_of_plate), 100, n), tolerance, "mm"};
}

}  // namespace

std::vector<Case> cookCases() {
  return {{"cook-membrane", false,
           [] {
             return std::vector{incompressible(8, 6.904, 0.002), incompressible(16, 6.919, 0.001),
                                equalLaws(8, 0.001), compressible(16, 0.001)};
           }},
          {"cook-membrane-fine", true, [] {
             return std::vector{incompressible(32, 6.926, 0.001), equalLaws(16, 0.001),
                                compressible(32, 0.001)};
           }}};
}

}  // namespace palpate::verification
