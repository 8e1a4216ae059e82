#include "viewer/live/unsolved_dataset.hpp"

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/dataset/dataset.hpp"

namespace palpate {
namespace {

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

}  // namespace

UnsolvedDataset::UnsolvedDataset(Problem whole) {
  const Problem problem = withoutProbes(std::move(whole));
  std::vector<SpaceTable> spaces;
  for (const ActivePatch& patch : problem.active) {
    if (!patch.finger)
      throw badInput(
          "scene \"{}\": active \"{}\" is not a finger; a scene without a dataset can be touched "
          "only by fingers (tool = \"finger\")",
          problem.scene.name, patch.name);
    if (patch.finger->radius != problem.active.front().finger->radius)
      throw badInput(
          "scene \"{}\": its fingers have several radii; a scene without a dataset can be touched "
          "only by fingers of one radius",
          problem.scene.name);
    SpaceTable& space = spaces.emplace_back();
    space.patch = patch;
    space.lattice = uniformLattice(problem.scene, patch);
    space.points.resize(at(space.lattice.size()));
  }
  file_ = folder_ / (problem.scene.name + ".h5");
  const auto none = [](std::size_t, std::int32_t) -> NodalFields {
    throw failure("a dataset without solutions has no nodal fields");
  };
  sealDataset(file_, problem, rowsOf(spaces), "none", none, /*partial=*/true);
}

}  // namespace palpate
