#include "tests/verification/rig.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "worker/elements/kernel_family.hpp"

namespace palpate::verification {

Material mooneyRivlin(double c10, double c01) {
  return {.law = LawName::mooney_rivlin, .c10 = c10, .c01 = c01};
}

Material neoHookean(double mu, std::optional<double> bulk) {
  return {.law = LawName::neo_hookean, .mu = mu, .bulk = bulk};
}

Material stVenantKirchhoff(double young, double poisson) {
  return {.law = LawName::st_venant_kirchhoff, .young = young, .poisson = poisson};
}

BodyModel bodyOf(Mesh mesh, const Discretization& discretization, const Material& material) {
  BodyModel body;
  body.mesh = std::move(mesh);
  if (discretization.displacement == DisplacementSpace::p2) addMidEdgeNodes(body.mesh);
  body.discretization = discretization;
  body.materials = {material};
  body.region_of.assign(body.mesh.tetrahedra.size(), 0);
  if (!material.fibers.empty()) {
    std::array<Eigen::Vector3d, 2> directions = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    PALPATE_ASSERT(material.fibers.size() <= directions.size(), "at most two fibre families");
    std::copy(material.fibers.begin(), material.fibers.end(), directions.begin());
    body.fibers.assign(body.mesh.tetrahedra.size(), directions);
  }
  body.fixed.assign(3 * body.mesh.nodes.size(), 0);
  return body;
}

void hold(BodyModel& body, const std::vector<std::int32_t>& nodes, std::string_view axes) {
  PALPATE_ASSERT(!nodes.empty(), "there must be nodes to fix");
  for (const std::int32_t node : nodes)
    for (const char axis : axes) body.fixed[3 * node + (axis - 'x')] = 1;
}

void hold(BodyModel& body, const std::string& group, std::string_view axes) {
  hold(body, body.mesh.node_groups.at(group), axes);
}

void holdSymmetryPlanes(BodyModel& body) {
  for (const int axis : {0, 1, 2})
    hold(body, nodesInPlane(body.mesh, axis, 0), std::string_view("xyz").substr(axis, 1));
}

std::vector<std::int32_t> nodesInPlane(const Mesh& mesh, int axis, double value) {
  const double size = boundingBox(mesh).diagonal().norm();
  std::vector<std::int32_t> nodes;
  for (std::size_t node = 0; node < mesh.nodes.size(); ++node)
    if (std::abs(mesh.nodes[node][axis] - value) < 1e-9 * size)
      nodes.push_back(static_cast<std::int32_t>(node));
  return nodes;
}

std::vector<Triangle> facesWhere(const Mesh& mesh,
                                 const std::function<bool(const Eigen::Vector3d& X)>& chosen) {
  std::vector<Triangle> faces;
  for (const Triangle& face : mesh.surface)
    if (std::all_of(face.begin(), face.end(),
                    [&](std::int32_t node) { return chosen(mesh.nodes[node]); }))
      faces.push_back(face);
  PALPATE_ASSERT(!faces.empty(), "the loaded side must have faces");
  return faces;
}

State displaced(const System& system,
                const std::function<Eigen::Vector3d(const Eigen::Vector3d& X)>& u) {
  State state = system.restState();
  const std::vector<Eigen::Vector3d>& nodes = system.model().mesh.nodes;
  for (std::size_t node = 0; node < nodes.size(); ++node) ofNode(state.u, node) = u(nodes[node]);
  return state;
}

Rig::Rig(const BodyModel& body) : system_(body, chooseKernels()), solver_(system_) {}

NewtonResult Rig::seek(State start, const Eigen::Vector3d& tool) {
  return findEquilibrium(system_, solver_, std::move(start), tool, options);
}

NewtonResult Rig::equilibrium(State start, const Eigen::Vector3d& tool) {
  NewtonResult result = seek(std::move(start), tool);
  if (result.cause != Cause::none)
    throw failure("no equilibrium: {} after {} iterations, residual {:.2g} N", name(result.cause),
                  result.iterations, result.residual.norm);
  return result;
}

NewtonResult Rig::loadInSteps(int steps) {
  NewtonResult reached;
  reached.state = system_.restState();
  for (int step = 1; step <= steps; ++step) {
    setLoadFactor(static_cast<double>(step) / steps);
    reached = equilibrium(std::move(reached.state));
  }
  return reached;
}

std::int32_t Rig::negativeEigenvalues(const State& state) {
  Residual residual;
  Tangent tangent;
  system_.assemble(state, residual, tangent);
  return solver_.factorize(tangent).negative_pivots;
}

NodalForces nodalForces(const BodyModel& body, const State& state) {
  // If nothing is fixed, loaded or moved by a tool, every displacement is an unknown, and the
  // residual is the derivative of the stored energy alone.
  BodyModel loose = body;
  loose.fixed.assign(loose.fixed.size(), 0);
  loose.load.clear();
  loose.tools.clear();
  const System system(std::move(loose), chooseKernels());
  Residual residual;
  system.assemble(state, residual);
  NodalForces forces(body.mesh.nodes.size(), 3);
  for (std::int32_t node = 0; node < forces.rows(); ++node)
    for (int i = 0; i < 3; ++i) forces(node, i) = residual.free[system.numbers().at({node, i})];
  return forces;
}

Eigen::Matrix3d meanStress(const BodyModel& body, const State& state) {
  const NodalForces forces = nodalForces(body, state);
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (Eigen::Index node = 0; node < forces.rows(); ++node)
    sum += forces.row(node).transpose() * body.mesh.nodes[node].transpose();
  return sum / measure(body.mesh).volume;
}

}  // namespace palpate::verification
