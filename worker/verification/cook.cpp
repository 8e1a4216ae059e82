// Cook's membrane: a tapered plate, clamped at the left, sheared at the right edge; plane strain by
// one layer of tetrahedra that keeps its thickness.
#include <fmt/format.h>

#include <cmath>

#include "worker/verification/case.hpp"
#include "worker/verification/meshes.hpp"
#include "worker/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double mm = 1e-3, newton_per_mm2 = 1e6;
constexpr double thickness = 1 * mm;

std::int32_t nodeAt(const Mesh& mesh, const Eigen::Vector3d& X) {
  std::int32_t nearest = 0;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if ((mesh.nodes[node] - X).norm() < (mesh.nodes[nearest] - X).norm())
      nearest = static_cast<std::int32_t>(node);
  return nearest;
}

/// Upward displacement of the tip (48, 60) mm under `force` newtons per mm of thickness, mm.
double tipDisplacement(const Discretization& discretization, const Material& material, double force,
                       int n) {
  BodyModel body = bodyOf(cookMesh(n, thickness), discretization, material);
  hold(body, nodesInPlane(body.mesh, 0, 0), "xyz");
  hold(body, "first", "z");
  hold(body, "last", "z");
  const auto right_edge = facesWhere(
      body.mesh, [](const Eigen::Vector3d& X) { return std::abs(X[0] - 48 * mm) < 1e-9; });
  addTraction(body, right_edge, {0, force / 16 * newton_per_mm2, 0});
  const NewtonResult result = Rig(body).loadInSteps(4);
  return displacementOf(result.state, nodeAt(body.mesh, {48 * mm, 60 * mm, 0}))[1] / mm;
}

constexpr double mu = 80.1938 * newton_per_mm2;

/// In plane strain with J = 1 both invariants are the same.
Material sameInPlaneStrain() { return mooneyRivlin(0.3 * mu / 2, 0.7 * mu / 2); }

Material dealII() {
  constexpr double shear = 0.4225 * newton_per_mm2, poisson = 0.3;
  Material material = neoHookean(shear);
  material.bulk = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson));
  return material;
}

Row incompressible(int n, double reference, double tolerance) {
  return {fmt::format("incompressible neo-Hookean P2/P1, n = {}: tip", n),
          tipDisplacement(taylor_hood, neoHookean(mu), 100, n), reference, tolerance, "mm"};
}

Row compressible(int n, double tolerance) {
  return {fmt::format("compressible neo-Hookean P2, n = {}: tip", n),
          tipDisplacement(p2_displacement, dealII(), 1, n), 13.772, tolerance, "mm"};
}

Row equalLaws(int n, double tolerance) {
  return {fmt::format("Mooney-Rivlin as neo-Hookean P2/P1, n = {}: tip", n),
          tipDisplacement(taylor_hood, sameInPlaneStrain(), 100, n),
          tipDisplacement(taylor_hood, neoHookean(mu), 100, n), tolerance, "mm"};
}

std::vector<Row> quickRows() {
  return {incompressible(8, 6.904, 0.002), incompressible(16, 6.919, 0.001), equalLaws(8, 0.001),
          compressible(16, 0.001)};
}

std::vector<Row> longRows() {
  return {incompressible(32, 6.926, 0.001), equalLaws(16, 0.001), compressible(32, 0.001)};
}

}  // namespace

std::vector<Case> cookCases() {
  return {{"cook-membrane", false, quickRows}, {"cook-membrane-fine", true, longRows}};
}

}  // namespace palpate::verification
