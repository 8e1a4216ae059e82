#pragma once

#include <utility>

#include "common/problem/problem.hpp"
#include "tests/support/meshes.hpp"

/// Scenes made in code for tests of solver and scheduler.
namespace palpate::test {

/// A scene with the Mooney-Rivlin constants of the paper, stabilized P1 elements and ln det F.
inline Scene mooneyRivlinScene() {
  Scene scene;
  scene.name = "test";
  scene.mesh = "test.msh";
  scene.regions[0].material = {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
  return scene;
}

/// A scene with the linear or a St. Venant-Kirchhoff law and the Young's modulus of the paper. It
/// has no pressure unless the material is incompressible.
inline Scene youngScene(LawName law, double poisson = 0.3) {
  Scene scene = mooneyRivlinScene();
  scene.regions[0].material = {.law = law, .young = 15480, .poisson = poisson};
  if (!isMixed(scene.regions[0].material)) scene.discretization.pressure = PressureSpace::none;
  return scene;
}

/// `scene` on `mesh`, side xmin fixed, one active node: the surface node nearest to `near`.
inline Problem clampedProblem(Scene scene, Mesh mesh, const Eigen::Vector3d& near,
                              double patch_radius = 0) {
  scene.fixed = {};
  scene.fixed.groups = {"xmin"};
  ActiveSelection active;
  active.name = "tip";
  active.near = near;
  active.radius = patch_radius;
  scene.active = {active};
  return resolve(std::move(scene), std::move(mesh));
}

/// `scene` on blobMesh(), side xmin fixed, a finger of this radius (m) at the other end.
inline Problem fingeredBlob(double radius, Scene scene = mooneyRivlinScene()) {
  scene.fixed.groups = {"xmin"};
  scene.active = {{.name = "finger",
                   .near = Eigen::Vector3d(0.1, 0.013, 0.02),
                   .radius = radius,
                   .tool = ToolKind::finger}};
  return resolve(std::move(scene), blobMesh());
}

}  // namespace palpate::test
