#include "worker/solver/body_model.hpp"

#include <Eigen/Geometry>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

void addLoad(BodyModel& model, std::int32_t node, const Eigen::Vector3d& force) {
  model.load.resize(3 * model.mesh.nodes.size(), 0.0);
  ofNode(model.load, node) += force;
}

bool isQuadratic(const BodyModel& model) {
  return model.discretization.displacement == DisplacementSpace::p2;
}

}  // namespace

PressureSpace pressureSpaceOf(const BodyModel& model, std::size_t region) {
  return isMixed(model.materials[region]) ? model.discretization.pressure : PressureSpace::none;
}

PressureSlots pressureSlots(const BodyModel& model) {
  return {model.discretization.pressure, model.mesh, model.materials, model.region_of};
}

bool hasNearlyRigidPart(const BodyModel& model) {
  constexpr double contrast = 1e4;
  return contrastOf(model.materials) > contrast;
}

BodyModel bodyModel(const Problem& problem) {
  BodyModel model;
  model.mesh = problem.mesh;
  model.discretization = problem.scene.discretization;
  for (const Region& region : problem.scene.regions) model.materials.push_back(region.material);
  model.region_of = problem.region_of;
  model.fibers = problem.fibers;
  model.fixed.assign(3 * problem.mesh.nodes.size(), 0);
  for (const std::int32_t node : problem.fixed)
    for (int i = 0; i < 3; ++i) model.fixed[3 * node + i] = 1;
  for (const ActivePatch& patch : problem.active)
    model.tools.push_back({patch.nodes, patch.weights});
  if (!problem.scene.gravity.isZero()) addGravity(model, problem.scene.gravity);
  return model;
}

void addTraction(BodyModel& model, const std::vector<Triangle>& faces,
                 const Eigen::Vector3d& traction) {
  const Mesh& mesh = model.mesh;
  for (const Triangle& face : faces) {
    const Eigen::Vector3d a = mesh.nodes[face[0]], b = mesh.nodes[face[1]], c = mesh.nodes[face[2]];
    // The integral of a linear shape function over a face is a third of the area. The integral of a
    // quadratic shape function is zero for a vertex and a third of the area for a mid-edge node.
    const Eigen::Vector3d third = traction * ((b - a).cross(c - a).norm() / 2) / 3;
    for (int corner = 0; corner < 3; ++corner) {
      const std::int32_t node = isQuadratic(model)
                                    ? midEdgeNode(mesh, face[corner], face[(corner + 1) % 3])
                                    : face[corner];
      PALPATE_ASSERT(node >= 0, "two corners of a face must be joined by an edge");
      addLoad(model, node, third);
    }
  }
}

void addGravity(BodyModel& model, const Eigen::Vector3d& acceleration) {
  const Mesh& mesh = model.mesh;
  for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
    const auto& density = model.materials[model.region_of[element]].density;
    if (!density) throw badInput("gravity needs the density of every material");
    const Eigen::Vector3d weight = acceleration * (*density * sixVolume(mesh, element) / 6);
    // The mean value of a shape function over the volume is 1/4 if it is linear. If it is
    // quadratic, it is -1/20 for a vertex and 1/5 for a mid-edge node.
    for (const std::int32_t node : mesh.tetrahedra[element])
      addLoad(model, node,
              isQuadratic(model) ? Eigen::Vector3d(-weight / 20) : Eigen::Vector3d(weight / 4));
    if (isQuadratic(model))
      for (const std::int32_t node : mesh.mid_edge_nodes[element]) addLoad(model, node, weight / 5);
  }
}

}  // namespace palpate
