#include "tests/support/finger_body.hpp"

#include <cmath>

#include "tests/support/meshes.hpp"
#include "tests/support/symmetric_slope.hpp"
#include "tests/support/touchable_body.hpp"

namespace palpate::test {
namespace {

const Eigen::Vector3d wave_vector(40, 25, 0);  // 1/m

double factorAt(const Eigen::Vector3d& s) { return 1 + 0.3 * std::sin(wave_vector.dot(s)); }
Eigen::Vector3d factorGradient(const Eigen::Vector3d& s) {
  return 0.3 * std::cos(wave_vector.dot(s)) * wave_vector;
}

Equilibrium equilibriumAt(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
  const ConvexEnergy f;
  Equilibrium e;
  e.energy = FingerBody::energy(s, p);
  e.force = FingerBody::force(s, p);
  e.stiffness = -factorAt(s) * f.hessian(p);
  e.drive = FingerBody::drive(s, p);
  e.drive_stiffness = -factorGradient(s) * f.gradient(p).transpose();
  const Eigen::Matrix3d bend =
      0.3 * std::sin(wave_vector.dot(s)) * wave_vector * wave_vector.transpose();
  e.drive_slope = f.energy(p) * bend;
  e.stiffness_by_p = -factorAt(s) * f.hessianSlope(p);
  e.stiffness_by_s = -slopeOf(f.hessian(p), factorGradient(s));
  e.drive_slope_by_p = slopeOf(bend, f.gradient(p));
  return e;
}

}  // namespace

double FingerBody::energy(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
  return factorAt(s) * ConvexEnergy().energy(p);
}
Eigen::Vector3d FingerBody::force(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
  return -factorAt(s) * ConvexEnergy().gradient(p);
}
Eigen::Vector3d FingerBody::drive(const Eigen::Vector3d& s, const Eigen::Vector3d& p) {
  return -ConvexEnergy().energy(p) * factorGradient(s);
}

FingerBody::FingerBody(std::int32_t probes, const std::string& fixed,
                       const SurfaceSelection& touched) {
  Scene scene;
  scene.name = "fingered";
  scene.mesh = "fingered.msh";
  scene.regions[0].material = {.law = LawName::mooney_rivlin, .c10 = 1300, .c01 = 1280};
  scene.fixed.groups = {fixed};
  scene.workspace = {.radius = 0.03, .spacing = 0.01, .max_force = 8.5};
  scene.accuracy.probes = probes;
  ActiveSelection active;
  active.name = "top";
  active.tool = ToolKind::finger;
  active.radius = 0.02;
  active.surface = touched;
  scene.active = {active};
  problem = resolve(std::move(scene), cubeMesh(0.1, 4));
  for (std::size_t s = 0; s < problem.active.size(); ++s) {
    const ActivePatch& patch = problem.active[s];
    SpaceTable& space = spaces.emplace_back();
    space.patch = patch;
    space.lattice = uniformLattice(problem.scene, patch);
    space.points.resize(static_cast<std::size_t>(space.lattice.size()));
    for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
      PointRecord& point = space.points[static_cast<std::size_t>(n)];
      point.tag = Tag::expandable;
      point.parent = 0;
      point.equilibrium = equilibriumAt(patch.finger->center, space.lattice.displacement(n));
      point.fields = fields(s, n).id();
    }
    if (!patch.probe) continue;
    Probe& probe = space.probes.emplace_back();
    probe.displacement = *patch.probe;
    probe.record.tag = Tag::expandable;
    probe.record.parent = 0;
    probe.record.equilibrium = equilibriumAt(patch.finger->center, *patch.probe);
  }
}

NodalFields FingerBody::fields(std::size_t space, std::int32_t point) const {
  return movedAround(problem, problem.active[space].finger->center,
                     spaces[space].lattice.displacement(point));
}

void FingerBody::seal(const std::filesystem::path& file) const {
  sealDataset(file, problem, rowsOf(spaces), "portable",
              [this](std::size_t space, std::int32_t point) { return fields(space, point); });
}

}  // namespace palpate::test
