// The stiffness k of four tools as a function of the element size h. The body is a unit cube, fixed
// at the bottom; the tool moves the middle of its top up (linear law, nu = 0.3). For a single node,
// k falls in proportion to h and has no positive limit, because a point load in three dimensions is
// singular. For patches of radius 1/8, k converges.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tests/verification/rig.hpp"

namespace palpate::verification {
namespace {

constexpr double patch_radius = 0.125;      ///< metres
const Eigen::Vector3d middle(0.5, 0.5, 1);  ///< of the top face

const Material linear = {
    .law = LawName::linear, .young = tissue::young, .poisson = tissue::poisson};

/// Returns k/E, metres, for the body's tool, moved along z.
double stiffness(const BodyModel& body) {
  Rig rig(body);
  const System& system = rig.system();
  const Eigen::Vector3d up(0, 0, 1e-3);
  const Eigen::VectorXd nothing = Eigen::VectorXd::Zero(system.unknowns());
  const NewtonResult result = rig.equilibrium(system.moved(system.restState(), nothing, 1, up), up);
  return result.residual.tool[2] / up[2] / tissue::young;
}

/// Returns k/E, metres, where the top nodes within `radius` of the middle are one rigid tool. h is
/// 1/elements.
double discStiffness(DisplacementSpace displacement, int elements, double radius) {
  BodyModel body = bodyOf(cubeMesh(1, elements), {displacement, PressureSpace::none}, linear);
  hold(body, "zmin", "xyz");
  Tool tool;
  for (const std::int32_t node : nodesInPlane(body.mesh, 2, 1))
    if ((body.mesh.nodes[node] - middle).norm() < radius + 1e-9) tool.nodes.push_back(node);
  body.tools = {tool};
  return stiffness(body);
}

/// Returns k/E, metres, of a tool as a scene defines it. A rigid tool includes all nodes within the
/// radius, also inside the body; a weighted tool includes only nodes of the surface.
double sceneStiffness(DisplacementSpace displacement, int elements, ToolKind kind,
                      const Eigen::Vector3d& place = middle) {
  Scene scene;
  scene.name = "contact stiffness";
  scene.regions[0].material = linear;
  scene.discretization = {displacement, PressureSpace::none};
  scene.fixed.groups = {"zmin"};
  scene.active = {{.name = "middle", .near = place, .radius = patch_radius, .tool = kind}};
  return stiffness(bodyModel(resolve(std::move(scene), cubeMesh(1, elements))));
}

Row singleNode(int elements) {
  const double k = discStiffness(DisplacementSpace::p1, elements, 0);
  return {fmt::format("single node P1, h = 1/{}: k/(E h)", elements), k * elements, 1.10, 0.03};
}

Row disc(DisplacementSpace displacement, int elements, double reference) {
  return {fmt::format("rigid disc {}, h = 1/{}: k/E", word(displacement), elements),
          discStiffness(displacement, elements, patch_radius), reference, 0.005, "m"};
}

/// Returns k/E, metres, of a weighted-average tool on a half-space.
///
/// The normal load is p(r) = 3/(pi a^2) (1 - (r/a)^2)^2. Its Hankel transform is 48 J3(z)/z^3 with
/// z = q a, where q is the wave number. The half-space has the compliance 2 (1 - nu^2)/(E q)
/// (Johnson, Contact Mechanics, 1985). So
///   E a/k = (1 - nu^2)/pi * integral of (48 J3/z^3)^2 dz,
/// where the integral is known in gamma functions (Weber and Schafheitlin).
double halfSpace() {
  const double integral = 48 * 48 * std::tgamma(6) * std::tgamma(0.5) /
                          (64 * std::pow(std::tgamma(3.5), 2) * std::tgamma(6.5));
  return std::numbers::pi * patch_radius / ((1 - tissue::poisson * tissue::poisson) * integral);
}

/// Compares k/E of the cube with k/E of a half-space. They differ by about 1 %. The rest of the
/// deviation is due to the mesh.
Row weighted(DisplacementSpace displacement, int elements, double tolerance) {
  return {fmt::format("weighted average {}, h = 1/{}: k/E", word(displacement), elements),
          sceneStiffness(displacement, elements, ToolKind::weighted_average), halfSpace(),
          tolerance, "m"};
}

/// The same comparison for a finger. Its centre is near the middle, and is not a node of any of
/// these meshes.
Row finger(DisplacementSpace displacement, int elements, double tolerance) {
  const Eigen::Vector3d beside(0.473, 0.519, 1);
  return {fmt::format("finger {}, h = 1/{}: k/E", word(displacement), elements),
          sceneStiffness(displacement, elements, ToolKind::finger, beside), halfSpace(), tolerance,
          "m"};
}

/// Compares the stiffness k on a mesh with k on a mesh twice as fine.
Row rigidPatch(int elements) {
  return {fmt::format("rigid patch P2, h = 1/{}, reference 1/{}: k/E", elements, 2 * elements),
          sceneStiffness(DisplacementSpace::p2, elements, ToolKind::rigid),
          sceneStiffness(DisplacementSpace::p2, 2 * elements, ToolKind::rigid), 0.1, "m"};
}

}  // namespace

std::vector<Case> contactStiffnessCases() {
  using enum DisplacementSpace;
  return {{"contact-stiffness", false,
           [] {
             return std::vector{singleNode(4),         singleNode(8),        singleNode(16),
                                disc(p1, 8, 0.359),    disc(p1, 16, 0.294),  disc(p2, 8, 0.2746),
                                weighted(p1, 16, 0.2), weighted(p2, 8, 0.1), finger(p1, 8, 0.65),
                                finger(p1, 16, 0.25),  finger(p2, 8, 0.12)};
           }},
          {"contact-stiffness-fine", true, [] {
             return std::vector{
                 disc(p1, 24, 0.292),    disc(p1, 32, 0.284),   disc(p2, 12, 0.2803),
                 rigidPatch(6),          weighted(p1, 32, 0.1), weighted(p2, 12, 0.05),
                 weighted(p2, 16, 0.04), finger(p1, 32, 0.12),  finger(p2, 16, 0.05)};
           }}};
}

}  // namespace palpate::verification
