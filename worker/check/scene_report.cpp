#include "worker/check/scene_report.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/machine.hpp"
#include "common/problem/problem_warnings.hpp"
#include "worker/elements/blas_kernels.hpp"
#include "worker/elements/kernel_family.hpp"

namespace palpate {
namespace {

/// With fewer paths than this, it is not clear where most paths end.
constexpr std::size_t fewest_telling_paths = 4;

std::vector<SceneReport::Space> spacesOf(const Problem& problem) {
  const std::size_t n_nodes = problem.mesh.nodes.size(), n_pressures = problem.pressures.count();
  std::vector<SceneReport::Space> spaces;
  for (std::size_t s = 0; s < problem.active.size(); ++s) {
    const ActivePatch& patch = problem.active[s];
    if (patch.probe) continue;
    const std::size_t moved = patch.weights.empty() ? patch.nodes.size() : 0;
    spaces.push_back({&patch, word(problem.scene.active[s].tool),
                      patch.finger ? patch.finger->center : problem.mesh.nodes[patch.node],
                      3 * (n_nodes - problem.fixed.size() - moved) + n_pressures});
  }
  return spaces;
}

/// Adds the warnings that are based on the measured paths.
void warnOfPaths(SceneReport& report) {
  const std::vector<Path>& paths = report.measured.paths;
  if (!report.measured.no_rest.empty()) {
    report.warnings.push_back("no rest state was found, so no configuration can be solved: " +
                              report.measured.no_rest);
    return;
  }
  PALPATE_ASSERT(!paths.empty(), "a body with a rest state must have a measured path");
  if (std::ranges::all_of(paths, [](const Path& path) {
        return path.end == PathEnd::failed && path.steps.size() == 1;
      })) {
    report.warnings.push_back(
        "none of " + std::to_string(paths.size()) +
        " trial paths from rest reaches its first point, so hardly anything can be solved: " +
        report.measured.no_first_step);
    return;
  }
  if (report.cost.reached >= 0.5 || paths.size() < fewest_telling_paths) return;
  const auto ended = [&](PathEnd end) {
    return static_cast<std::size_t>(std::ranges::count(paths, end, &Path::end));
  };
  // The workspace of a finger is deep on purpose, so that max_force limits the pushes. Paths that
  // end at max_force need no warning.
  const bool fingers = std::ranges::all_of(
      report.spaces, [](const SceneReport::Space& space) { return bool(space.patch->finger); });
  if (fingers && 2 * ended(PathEnd::failed) < paths.size()) return;
  const Workspace& workspace = report.problem->scene.workspace;
  report.warnings.push_back(fmt::format(
      "workspace.radius = {:.4g} m: only about {:.0f} % of the lattice points will be reached; of "
      "{} trial paths from rest, {} exceed workspace.max_force = {:.4g} N and {} cannot be solved; "
      "most points at {:.3g} m from rest are not reached: make the radius smaller",
      workspace.radius, 100 * report.cost.reached, paths.size(), ended(PathEnd::max_force),
      workspace.max_force, ended(PathEnd::failed), report.cost.usual_reach + workspace.spacing));
}

}  // namespace

SceneReport reportOf(const Problem& problem) {
  SceneReport report;
  report.problem = &problem;
  report.quality = measure(problem.mesh);
  report.lattice = uniformLattice(problem.scene);
  report.spaces = spacesOf(problem);
  PALPATE_ASSERT(!report.spaces.empty(), "a scene with probes must have another active node");
  PALPATE_ASSERT(problem.region_of.size() == problem.mesh.tetrahedra.size(),
                 "each tetrahedron must have a region");
  report.tetrahedra_in.resize(problem.scene.regions.size());
  report.volume_of.resize(problem.scene.regions.size());
  for (std::size_t e = 0; e < problem.region_of.size(); ++e) {
    ++report.tetrahedra_in[problem.region_of[e]];
    report.volume_of[problem.region_of[e]] += sixVolume(problem.mesh, e) / 6;
  }
  report.measured = measurePaths(problem);
  report.cost = buildCost(problem, report.measured);
  report.cores = coreCount();
  report.arithmetic = arithmetic(chooseKernels());
  report.warnings = warningsOf(problem);
  if (const std::string why = whyOtherBlasKernels(); !why.empty()) report.warnings.push_back(why);
  warnOfPaths(report);
  return report;
}

}  // namespace palpate
