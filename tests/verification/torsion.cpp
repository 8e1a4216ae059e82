// A cylinder whose ends rotate relative to each other at a constant distance. The axial force
// (Poynting's effect) distinguishes C10 from C01; the torque does not (Rivlin 1949).
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <numbers>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

using std::numbers::pi;
using tissue::c01, tissue::c10;

constexpr double radius = 0.01, height_of_bar = 0.01, twist = 50;  ///< m, m, rad/m
constexpr double R4 = radius * radius * radius * radius;
constexpr double exact_torque = pi * (c10 + c01) * twist * R4;  ///< N m
/// N; negative, because the bar presses outwards on its ends.
constexpr double exact_axial = -pi * twist * twist * R4 * (c10 + 2 * c01) / 2;

struct Reaction {
  double torque = 0, axial = 0;  ///< at the end z = height_of_bar
};

/// Returns the position of a point of the twisted bar.
Eigen::Vector3d turned(const Eigen::Vector3d& X) {
  return Eigen::AngleAxisd(twist * X[2], Eigen::Vector3d::UnitZ()) * X;
}

Reaction twisted(int n) {
  BodyModel body = bodyOf(cylinderMesh(radius, height_of_bar, n, n), taylor_hood, mooneyRivlin());
  hold(body, "first", "xyz");
  hold(body, "last", "xyz");
  Rig rig(body);
  const NewtonResult result = rig.equilibrium(displaced(
      rig.system(), [](const Eigen::Vector3d& X) { return Eigen::Vector3d(turned(X) - X); }));
  const NodalForces forces = nodalForces(body, result.state);
  Reaction reaction;
  for (const std::int32_t node : body.mesh.node_groups.at("last")) {
    const Eigen::Vector3d x = turned(body.mesh.nodes[node]), f = forces.row(node);
    reaction.torque += x.cross(f)[2];
    reaction.axial += f[2];
  }
  return reaction;
}

std::vector<Row> rowsOfMeshes(int n) {
  const Reaction coarse = twisted(n), fine = twisted(2 * n);
  const std::string meshes = fmt::format("P2/P1, n = {} to {}", n, 2 * n);
  return joined(
      {rowsOfSecondOrder(meshes + ": torque", coarse.torque, fine.torque, exact_torque, "N m"),
       rowsOfSecondOrder(meshes + ": axial force", coarse.axial, fine.axial, exact_axial, "N")});
}

}  // namespace

std::vector<Case> torsionCases() {
  return {{"torsion", false, [] { return rowsOfMeshes(3); }},
          {"torsion-fine", true, [] { return rowsOfMeshes(5); }}};
}

}  // namespace palpate::verification
