// Hard cases: a tool is pushed into a body from rest, with the transitions of `palpate solve`. The
// reference forces were computed with GetFEM on the same meshes, by
// tests/verification/hard_reference.py, except the forces of the bone with linear elements.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "tests/verification/rig.hpp"
#include "worker/elements/kernel_family.hpp"
#include "worker/solver/path.hpp"

namespace palpate::verification {
namespace {

/// A tool pushed into a body that is fixed at the side zmin.
struct Push {
  std::string name;
  Mesh mesh;  ///< with the element groups "soft" and "stiff" for two regions
  std::vector<Region> regions;
  Discretization discretization;
  Eigen::Vector3d near = {0.02, 0.02, 0.04};  ///< metres
  double radius = 0.0101;                     ///< metres
  ToolKind tool = ToolKind::rigid;
  Eigen::Vector3d displacement = {0, 0, -1e-3};  ///< metres
  int transitions = 1;
};

Problem problemOf(const Push& push) {
  Scene scene;
  scene.name = push.name;
  scene.regions = push.regions;
  scene.discretization = push.discretization;
  scene.fixed.groups = {"zmin"};
  scene.active = {{.name = "tip", .near = push.near, .radius = push.radius, .tool = push.tool}};
  return resolve(std::move(scene), push.mesh);
}

/// Solves a push. If the tool does not arrive, returns one row with the share of the path that it
/// covered. Otherwise returns a row for validity and a row for the force.
std::vector<Row> rowsOfPush(const Push& push, double force, double tolerance) {
  const Problem problem = problemOf(push);
  TransitionSolver solver(problem, chooseKernels());
  Reached path;
  if (const auto rest = solver.startAtRest(path.outcome.failure()))
    path = walk(solver, *rest, push.displacement, push.transitions);
  const Outcome& outcome = path.outcome;
  if (!outcome.converged())
    return {{fmt::format("{}: {}, share of the path", push.name, name(outcome.failure().cause)),
             outcome.failure().step_reached, 1, 0}};
  return {{push.name + ": all valid", path.min_det_F > 0 ? 1.0 : 0.0, 1, 0},
          {push.name + ": force", outcome.equilibrium().force.norm(), force, tolerance, "N"}};
}

// ---- the bodies -------------------------------------------------------------------------------

constexpr double soft_mu = 3000, cube_edge = 0.04;

/// Assigns each element to one of the two regions.
void divide(Mesh& mesh, const std::function<bool(const Eigen::Vector3d& X)>& isStiff) {
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e)
    mesh.element_groups[isStiff(middleOf(mesh, e)) ? "stiff" : "soft"].push_back(
        static_cast<std::int32_t>(e));
}

/// A cube of 40 mm with a stiffer top quarter.
Push skin(const std::string& element, const Discretization& discretization, double contrast,
          int n) {
  Push push{.name = fmt::format("skin {} times stiffer, {}, n = {}", contrast, element, n),
            .mesh = cubeMesh(cube_edge, n),
            .regions = {{"soft", neoHookean(soft_mu)}, {"stiff", neoHookean(contrast * soft_mu)}},
            .discretization = discretization,
            .radius = 0.0145,
            .tool = ToolKind::weighted_average};
  divide(push.mesh, [](const Eigen::Vector3d& X) { return X[2] > 0.03; });
  return push;
}

/// The cube of skin(), with a top quarter of capsule tissue that contains two crossed families of
/// collagen fibres.
Push capsule(double depth) {
  Push push = skin("", taylor_hood, 1, 4);
  Material& collagen = push.regions[1].material;
  collagen = {.law = LawName::holzapfel_gasser_ogden, .mu = 5000, .k1 = 500e3, .k2 = 20};
  collagen.fibers = {Eigen::Vector3d(1, 1, 0).normalized(), Eigen::Vector3d(1, -1, 0).normalized()};
  push.name = fmt::format("capsule with fibres, {} mm", 1e3 * depth);
  push.radius = 0.0101;
  push.tool = ToolKind::rigid;
  push.displacement = {0, 0, -depth};
  return push;
}

/// A cube of 60 mm of soft tissue that contains a cube of 20 mm of bone.
Push bone(double young, const Discretization& discretization = stabilized) {
  Push push{.name = fmt::format("bone of {:g} Pa in tissue of {:g}, {}", young, 3 * soft_mu,
                                word(discretization.displacement)),
            .mesh = cubeMesh(0.06, 6),
            .regions = {{"soft", neoHookean(soft_mu)}, {"stiff", stVenantKirchhoff(young)}},
            .discretization = discretization,
            .near = {0.03, 0.03, 0.06},
            .displacement = {0, 0, -5e-3}};
  divide(push.mesh, [](const Eigen::Vector3d& X) {
    return (X.array() > 0.02).all() && (X.array() < 0.04).all();
  });
  return push;
}

/// A column of 10 x 10 x 80 mm, compressed along its length by its whole top.
Push column(double depth) {
  return {.name = fmt::format("column, {} mm, Euler's load at 4.11 mm", 1e3 * depth),
          .mesh = boxMesh({0.01, 0.01, 0.08}, {2, 2, 16}),
          .regions = {{"", neoHookean(soft_mu)}},
          .discretization = taylor_hood,
          .near = {0.005, 0.005, 0.08},
          .radius = 0.0072,
          .displacement = {0, 0, -depth}};
}

/// A cube of 40 mm with fibres, pressed by `depth` metres. There is one fibre family along x, or
/// two that are rotated from x by `angle` degrees to both sides.
Push fibers(const std::string& what, Material material, double depth, double angle = 0) {
  const double turned = angle * std::numbers::pi / 180;
  material.law = LawName::holzapfel_gasser_ogden;
  material.fibers = {Eigen::Vector3d(std::cos(turned), std::sin(turned), 0)};
  if (angle != 0) material.fibers.emplace_back(std::cos(turned), -std::sin(turned), 0);
  return {.name = fmt::format("{}, {} mm", what, 1e3 * depth),
          .mesh = cubeMesh(cube_edge, 4),
          .regions = {{"", material}},
          .discretization = taylor_hood,
          .displacement = {0, 0, -depth}};
}

Push fibers(double stiffness, double depth) {
  return fibers(fmt::format("fibres, k1/mu = {}", stiffness),
                {.mu = soft_mu, .k1 = stiffness * soft_mu, .k2 = 0.84}, depth);
}

/// Tissues of arteries: carotid media of a rabbit (Holzapfel, Gasser, Ogden 2000), and iliac
/// adventitia of a man (Gasser, Ogden, Holzapfel 2006).
Push media(double depth) {
  return fibers("media", {.mu = 3000, .k1 = 2363.2, .k2 = 0.8393}, depth, 29);
}
Push adventitia(double depth) {
  return fibers("adventitia", {.mu = 300, .k1 = 562, .k2 = 0.7112}, depth, 62);
}
Push dispersedAdventitia(double depth) {
  return fibers("dispersed adventitia",
                {.mu = 7640, .k1 = 996.6e3, .k2 = 524.6, .dispersion = 0.226}, depth, 49.98);
}

/// A body of soft tissue, pressed from above.
Push soft(const std::string& what, Mesh mesh, double radius, double depth) {
  const double top = boundingBox(mesh).max()[2];
  return {.name = what,
          .mesh = std::move(mesh),
          .regions = {{"", neoHookean(soft_mu)}},
          .discretization = taylor_hood,
          .near = {cube_edge / 2, cube_edge / 2, top},
          .radius = radius,
          .displacement = {0, 0, -depth}};
}

/// A compressible cube, pressed by almost a third of its height.
Push compression() {
  Push push = soft("pressed in by 12 of 40 mm, nu = 0.49", cubeMesh(cube_edge, 4), 0.0101, 12e-3);
  push.regions[0].material.bulk = 149e3;
  return push;
}

/// A cube of a law with Poisson's ratio, nearly incompressible.
Push nearlyIncompressible(LawName law) {
  Push push = soft(fmt::format("{}, nu = 0.499", word(law)), cubeMesh(cube_edge, 4), 0.0101, 1e-3);
  push.regions[0].material = {.law = law, .young = 9000, .poisson = 0.499};
  return push;
}

/// A pyramid with a tip a tenth as wide as its base, pressed down at the tip by almost a third of
/// its height.
Push tip() {
  Mesh mesh = boxMesh({cube_edge, cube_edge, cube_edge}, {4, 4, 8});
  for (Eigen::Vector3d& node : mesh.nodes)
    for (const int axis : {0, 1})
      node[axis] = cube_edge / 2 + (1 - 0.9 * node[2] / cube_edge) * (node[axis] - cube_edge / 2);
  return soft("pyramid, pressed in at its tip", std::move(mesh), 0.003, 4e-3);
}

std::vector<Row> interfaces() {
  // The limits to which P1-stabilized converges from above: the forces of P2/P1 with n = 16.
  constexpr double limit_10 = 0.430637, limit_100 = 0.624664;
  return joined({rowsOfPush(skin("P2/P1", taylor_hood, 10, 4), 0.427129, 1e-4),
                 rowsOfPush(skin("P2/P1", taylor_hood, 10, 8), 0.432723, 1e-4),
                 rowsOfPush(skin("P2/P1", taylor_hood, 100, 4), 0.636215, 1e-4),
                 rowsOfPush(skin("P2/P1", taylor_hood, 100, 8), 0.629640, 1e-4),
                 rowsOfPush(skin("P1-stabilized", stabilized, 10, 8), limit_10, 0.07),
                 rowsOfPush(skin("P1-stabilized", stabilized, 10, 16), limit_10, 0.03),
                 rowsOfPush(skin("P1-stabilized", stabilized, 100, 8), limit_100, 0.08),
                 rowsOfPush(skin("P1-stabilized", stabilized, 100, 16), limit_100, 0.03)});
}

}  // namespace

std::vector<Case> hardCases() {
  return {{"hard-interfaces", false, interfaces},
          {"hard-contrast", false,
           [] {
             return joined({rowsOfPush(bone(1e8), 2.374, 1e-3), rowsOfPush(bone(1e10), 2.374, 1e-3),
                            rowsOfPush(bone(1e10, taylor_hood), 1.87327, 1e-4)});
           }},
          {"hard-column", false,
           [] {
             Push in_steps = column(10e-3);
             in_steps.name += ", in 8 steps";
             in_steps.transitions = 8;
             return joined({rowsOfPush(column(5e-3), 0.0550424, 1e-5),
                            rowsOfPush(column(10e-3), 0.0553038, 1e-5),
                            rowsOfPush(in_steps, 0.0553038, 1e-5)});
           }},
          {"hard-fibres", false,
           [] {
             return joined({rowsOfPush(fibers(10, 1e-3), 0.32701, 1e-4),
                            rowsOfPush(fibers(100, 1e-6), 0.344984e-3, 1e-4),
                            rowsOfPush(fibers(100, 1e-3), 0.356762, 1e-4),
                            rowsOfPush(fibers(100, 6e-3), 2.6197, 1e-4),
                            rowsOfPush(fibers(1000, 1e-6), 0.363647e-3, 1e-4),
                            rowsOfPush(fibers(1000, 1e-3), 0.378154, 1e-4),
                            rowsOfPush(fibers(1000, 12e-3), 8.09876, 1e-4)});
           }},
          {"hard-arteries", false,
           [] {
             return joined({rowsOfPush(media(1e-6), 0.309710e-3, 1e-4),
                            rowsOfPush(media(6e-3), 2.27448, 1e-4),
                            rowsOfPush(media(12e-3), 6.23758, 1e-4),
                            rowsOfPush(adventitia(1e-6), 0.0355532e-3, 1e-4),
                            rowsOfPush(adventitia(6e-3), 0.282896, 1e-4),
                            rowsOfPush(adventitia(12e-3), 0.842489, 1e-4),
                            rowsOfPush(dispersedAdventitia(1e-6), 2.3299e-3, 1e-4),
                            rowsOfPush(dispersedAdventitia(1.5e-3), 7.81461, 1e-4),
                            rowsOfPush(capsule(2e-3), 0.861549, 1e-4),
                            rowsOfPush(capsule(6e-3), 3.10256, 1e-4)});
           }},
          {"hard-shapes", false, [] {
             const Eigen::Vector3d cube(cube_edge, cube_edge, cube_edge);
             return joined(
                 {rowsOfPush(nearlyIncompressible(LawName::linear), 0.24539, 1e-4),
                  rowsOfPush(nearlyIncompressible(LawName::st_venant_kirchhoff), 0.229295, 1e-4),
                  rowsOfPush(compression(), 3.27098, 1e-4), rowsOfPush(tip(), 0.207386, 1e-4),
                  rowsOfPush(soft("one layer on bone",
                                  boxMesh({cube_edge, cube_edge, 0.01}, {4, 4, 1}), 0.0075, 2e-3),
                             3.86135, 1e-4),
                  rowsOfPush(soft("flat elements", boxMesh(cube, {4, 4, 64}), 0.0101, 6e-3),
                             1.70896, 1e-4)});
           }}};
}

}  // namespace palpate::verification
