#include "worker/check/build_cost.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/space/halving_forecast.hpp"
#include "common/space/lattice.hpp"

namespace palpate {
namespace {

/// If a point cannot be reached from one neighbour, a build tries it from others. The estimate
/// assumes two tries in total for each of these points, and that half of the points are reached.
constexpr double tries_after_failure = 2, reached_after_failure = 0.5;
/// Factor by which waiting lengthens a build: waiting for ready transitions, for messages, and for
/// the disk.
constexpr double waiting = 1.2;

/// Ratio of two errors. The first is the likely error at the worst place of a cell, which decides
/// whether the cell is split (nextRefinement). The second is measured half-way along a step of a
/// path.
constexpr double worst_in_cell = 5;
/// Number of points that a split cell adds if its neighbours are split too.
constexpr double points_of_cell = 7;

/// Estimates for the lattice points between n and n + 1 spacings from rest.
struct Shell {
  double points = 0;
  double seconds = 0;  ///< average over all points; zero for points that are not tried
  double reached = 0;  ///< share of the points that are reached
  double more = 0;     ///< average number of points that splits add per point
};

/// Returns the number of points that splits add per lattice point, for lattice points like the end
/// of step n of `path`. The cells at a reached point are split as often as its error demands. The
/// cells at an unreached point are split at every level. For a finger, however, they are split only
/// once; if they touch the rest position (n = 0), their part at rest is split at every level
/// (nextRefinement).
double added(const Path& path, std::size_t n, bool finger, std::int32_t levels) {
  const PathStep& step = path.steps[n];
  if (step.reached) return points_of_cell * cellsHalved(worst_in_cell * step.error, levels);
  if (finger) return points_of_cell * (n == 0 ? levels : std::min(1, levels));
  return points_of_cell * cellsHalved(std::numeric_limits<double>::infinity(), levels);
}

/// Counts the lattice points of one space, shell by shell. For a finger that only pushes, the
/// lattice covers only the pushed part.
void add(const Lattice& lattice, std::vector<Shell>& shells) {
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    const double spacings = lattice.displacement(n).norm() / lattice.spacing();
    const auto shell = static_cast<std::size_t>(std::max(0.0, std::ceil(spacings - 1e-9) - 1));
    if (shell >= shells.size()) shells.resize(shell + 1);
    ++shells[shell].points;
  }
}

/// Estimates time and reach of each shell with the Kaplan-Meier estimator. The paths that were cut
/// correspond to patients who leave a study early. The share of paths that end in a shell is taken
/// among the paths that reached it, so paths that were cut earlier do not matter. A shell that no
/// path reached costs as much per point as the shell before it.
void fill(std::vector<Shell>& shells, const std::vector<Path>& paths, bool finger,
          std::int32_t levels) {
  double going_on = paths.empty() ? 0 : 1;  // share of the paths that have not ended
  double seconds_each = 0;
  for (std::size_t n = 0; n < shells.size(); ++n) {
    double tried = 0, stopped = 0, too_strong = 0, seconds = 0, more = 0;
    for (const Path& path : paths) {
      if (n >= path.steps.size()) continue;
      const PathStep& step = path.steps[n];
      const bool last = n + 1 == path.steps.size();
      ++tried;
      more += added(path, n, finger, levels);
      seconds += step.seconds * (step.reached ? 1 : tries_after_failure);
      stopped += step.reached ? 0 : 1;
      too_strong += last && path.end == PathEnd::max_force ? 1 : 0;
    }
    // A point can be reached from another neighbour only if that neighbour is reached itself.
    const double failed =
        tried > 0 ? stopped * (1 - reached_after_failure * (1 - stopped / tried)) : 0;
    if (tried > 0) seconds_each = seconds / tried;
    shells[n].seconds = going_on * seconds_each;
    shells[n].more = tried > 0 ? going_on * more / tried : 0;
    shells[n].reached = tried > 0 ? going_on * (1 - failed / tried) : going_on;
    if (tried > 0) going_on *= 1 - (failed + too_strong) / tried;
  }
}

}  // namespace

BuildCost buildCost(const Problem& problem, const MeasuredPaths& measured) {
  const Lattice lattice = uniformLattice(problem.scene);
  PALPATE_ASSERT(lattice.size() > 0, "a lattice must contain the origin");
  double probes = 0, points = 0;
  std::vector<Shell> shells;
  for (std::size_t s = 0; s < problem.active.size(); ++s) {
    probes += probesIn(problem.scene, s);
    if (problem.active[s].probe) continue;
    add(uniformLattice(problem.scene, problem.active[s]), shells);
  }
  for (const Shell& shell : shells) points += shell.points;
  const Accuracy& accuracy = problem.scene.accuracy;
  fill(shells, measured.paths, problem.active[0].finger.has_value(),
       accuracy.adaptive() ? accuracy.levels : 0);
  BuildCost cost;
  double seconds = 0, reached = 0, more = 0;
  for (std::size_t n = 0; n < shells.size(); ++n) {
    const Shell& shell = shells[n];
    seconds += shell.points * shell.seconds;
    reached += shell.points * shell.reached;
    more += shell.points * shell.more;
    if (shell.reached >= 0.5)
      cost.usual_reach = std::min(lattice.radius(), static_cast<double>(n + 1) * lattice.spacing());
  }
  cost.reached = reached / points;
  PALPATE_ASSERT(cost.reached >= 0 && cost.reached <= 1 + 1e-9, "a share must be between 0 and 1");

  const double seconds_each = waiting * seconds / points;
  const auto bytes_each = static_cast<double>(storedBytes(problem));
  const auto estimate = [&](double of_spaces) {
    const double configurations = of_spaces + probes;
    return Estimate{std::llround(configurations), configurations * seconds_each,
                    std::llround(of_spaces * bytes_each)};
  };
  cost.least = estimate(points);
  cost.likely = estimate(points + more);
  return cost;
}

}  // namespace palpate
