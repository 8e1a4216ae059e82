#include "viewer/live/guessed_dataset.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/dataset/dataset.hpp"

namespace palpate {
namespace {

/// Stiffness of a finger on a body, divided by Young's modulus and the finger's radius. It is lower
/// than that of a half-space, because organs are thin and give way as a whole.
constexpr double stiffness_share = 0.5;
/// Distance from the finger, in its radii, at which the guessed shape ends.
constexpr double shape_radii = 3;

double springOf(const Scene& scene, double radius) {
  const auto modulusOf = [](const Region& region) { return youngModulus(region.material); };
  return stiffness_share * std::ranges::min(mapped(scene.regions, modulusOf)) * radius;
}

/// Removes the probes and sets the coarsest lattice, because a guess is neither refined nor
/// measured.
Problem withoutProbes(Problem problem) {
  PALPATE_ASSERT(problem.active.size() == problem.scene.active.size(),
                 "areas must be split into sites");
  std::erase_if(problem.active, [](const ActivePatch& patch) { return patch.probe.has_value(); });
  std::erase_if(problem.scene.active, [](const ActiveSelection& a) { return a.isProbe(); });
  problem.scene.accuracy = {};
  problem.scene.workspace.spacing = problem.scene.workspace.radius;
  return problem;
}

NodalFields shapeAt(const Problem& problem, const Finger& finger, const Eigen::Vector3d& p) {
  NodalFields fields;
  for (const Eigen::Vector3d& node : problem.mesh.nodes) {
    const double x = (node - finger.center).norm() / (shape_radii * finger.radius);
    const double share = x < 1 ? (1 - x * x) * (1 - x * x) : 0;
    for (int axis = 0; axis < 3; ++axis)
      fields.displacement.push_back(static_cast<float>(share * p[axis]));
  }
  fields.pressure.assign(problem.pressures.count(), 0.0f);
  return fields;
}

SpaceTable springAt(const Problem& problem, const ActivePatch& patch) {
  const double spring = springOf(problem.scene, patch.finger->radius);
  SpaceTable space;
  space.patch = patch;
  space.lattice = uniformLattice(problem.scene, patch);
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    const Eigen::Vector3d p = space.lattice.displacement(n);
    PointRecord& point = space.points.emplace_back();
    point.tag = Tag::expandable;
    point.parent = 0;
    point.equilibrium.energy = 0.5 * spring * p.squaredNorm();
    point.equilibrium.force = -spring * p;
    point.equilibrium.stiffness = -spring * Eigen::Matrix3d::Identity();
    point.fields = shapeAt(problem, *patch.finger, p).id();
  }
  return space;
}

}  // namespace

GuessedDataset::GuessedDataset(Problem whole) {
  const Problem problem = withoutProbes(std::move(whole));
  std::vector<SpaceTable> spaces;
  for (const ActivePatch& patch : problem.active) {
    if (!patch.finger)
      throw badInput(
          "scene \"{}\": active \"{}\" is not a finger; a scene without a dataset can be touched "
          "only by fingers (tool = \"finger\")",
          problem.scene.name, patch.name);
    spaces.push_back(springAt(problem, patch));
  }
  file_ = folder_ / (problem.scene.name + ".h5");
  sealDataset(file_, problem, rowsOf(spaces), "guessed",
              [&](std::size_t space, std::int32_t point) {
                return shapeAt(problem, *problem.active[space].finger,
                               spaces[space].lattice.displacement(point));
              });
}

}  // namespace palpate
