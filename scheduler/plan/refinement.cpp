#include "scheduler/plan/refinement.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/interpolation/field_error.hpp"
#include "common/problem/problem.hpp"
#include "common/space/halving_forecast.hpp"

namespace palpate {
namespace {

/// Positions per axis at which a leaf's error is sampled.
constexpr int samples = 5;

/// Likely error as a fraction of the bound of field_error.hpp. The bound holds at 99 % of
/// positions; in the median it is 6 to 11 times the error.
///
/// Measured at 1000 exact solutions (liver-493, Mooney-Rivlin, ball of 60 mm), for an accuracy of 3
/// % or 10 mN: with 0.2, refinement makes 83 configurations, which meet the accuracy at 99.5 % of
/// the positions. With 0.25 it makes 108 configurations for 100 %; with 0.15 it stops at 98.8 %.
constexpr double likely_share = 0.2;

/// Fraction of the ball in which the likely error must meet the accuracy. The remaining positions
/// lie next to jumps between branches, where no number of points would be enough.
constexpr double enough = 0.998;
/// The same fraction for a finger. A lower fraction is enough, because a place of the area is
/// answered from several neighbouring sites (docs/internals/thresholds.md).
constexpr double enough_of_finger = 0.99;

/// Largest distance from the ball at which a corner outside it is solved, in edge lengths of the
/// leaf. Farther corners stay unsolved (ghosts): displacements far beyond the ball may lie behind
/// folds, and the leaf can be split instead.
constexpr double reach_outside = 0.25;

/// Average number of points that the split of a cell adds: seven if its neighbours are split too,
/// fewer at the rim of the ball.
constexpr double points_of_cell = 5;

/// Compares the likely error of one configuration space with the allowed error, leaf by leaf.
class CellInspection {
 public:
  CellInspection(const SpaceTable& space, const Scene& scene)
      : space_(space),
        accuracy_(scene.accuracy),
        max_force_(scene.workspace.max_force),
        tree_(space),
        jumps_(inconsistentEdges(space)),
        suspects_(suspectEdges(space)) {
    LocalFits fits(space.lattice.unit(), space.patch.finger ? finger_fit : LocalFits::Kind());
    const std::vector<LocalPolynomial> polynomials =
        slotPolynomials(tree_, space, jumps_, ghostPolynomials(tree_, space, jumps_, fits), fits);
    jets_ = energyJets(tree_, polynomials);
    const FieldError error(tree_, polynomials, jets_, suspects_);
    for (std::int32_t leaf = 0; leaf < static_cast<std::int32_t>(tree_.leaves().size()); ++leaf)
      inspect(leaf, error);
  }

  Refinement refine() const {
    Refinement result;
    result.kept = samples_ > 0 ? kept_ / samples_ : 1;
    const bool is_enough = result.kept >= (space_.patch.finger ? enough_of_finger : enough);
    std::set<LatticePoint> points;
    double halved_later = 0;
    for (const auto& [leaf, ratio] : poor_) {
      if (is_enough && !endsBesideRest(leaf)) continue;
      if (allTerminating(leaf) || isAtJump(leaf) || isAtEnd(leaf)) continue;
      const std::vector<LatticePoint> untried = untriedCorners(leaf);
      // Assume that half of the leaves with untried corners need no split once these are solved.
      const double halved = halvedIn(leaf, ratio);
      halved_later += untried.empty() ? std::max(0.0, halved - 1) : halved / 2;
      points.insert(untried.begin(), untried.end());
      const LatticeCell& cell = tree_.leaves()[at(leaf)];
      if (untried.empty() && cell.level < accuracy_.levels &&
          (space_.lattice.divisions() >> cell.level) > 1)
        result.splits.push_back(cell);
    }
    std::ranges::sort(result.splits, coarserFirst);
    addNewCorners(result.splits, points);
    result.points.assign(points.begin(), points.end());
    std::ranges::sort(result.points, {},
                      [](const LatticePoint& p) { return std::pair(squaredNorm(p), p); });
    result.later = points_of_cell * halved_later;
    return result;
  }

 private:
  void inspect(std::int32_t leaf, const FieldError& error) {
    const Eigen::Vector3d lowest = tree_.displacement(tree_.corners(leaf)[0]);
    double worst = 0;
    for (int n = 0; n < samples * samples * samples; ++n) {
      const int i = n % samples, j = n / samples % samples, k = n / samples / samples;
      const Eigen::Vector3d local = (Eigen::Vector3d(i, j, k).array() + 0.5) / samples;
      const Eigen::Vector3d displacement = lowest + tree_.edge(leaf) * local;
      if (displacement.norm() > tree_.radius()) continue;
      const double force = evaluateEnergy(tree_, jets_, {leaf, local}).force.norm();
      if (!isPromised(displacement, force)) continue;
      const double allowed = std::max(accuracy_.force_error * force, accuracy_.force_floor);
      const double ratio = likely_share * error.bound(leaf, local) / allowed;
      const double volume = std::pow(tree_.edge(leaf) / tree_.spacing(), 3);
      samples_ += volume;
      if (ratio <= 1) kept_ += volume;
      worst = std::max(worst, ratio);
    }
    if (worst > 1 || endsBesideRest(leaf)) poor_.emplace_back(leaf, worst);
  }

  /// True at positions where the accuracy is promised. For a finger this excludes displacements
  /// that contact cannot reach, and forces above max_force.
  bool isPromised(const Eigen::Vector3d& displacement, double force) const {
    const auto& finger = space_.patch.finger;
    return !finger || (force <= max_force_ && finger->reach.contains(displacement));
  }

  /// Estimates how many cells, including this leaf, must be split until the leaf meets the
  /// accuracy. A leaf with a failed corner is split as often as levels allow. For a finger it is
  /// split only once (isAtEnd), unless endsBesideRest() is true.
  double halvedIn(std::int32_t leaf, double ratio) const {
    const int left = accuracy_.levels - tree_.leaves()[at(leaf)].level;
    if (!hasFailedCorner(leaf)) return cellsHalved(ratio, left);
    const bool once = space_.patch.finger && !endsBesideRest(leaf);
    return cellsHalved(std::numeric_limits<double>::infinity(), once ? 1 : left);
  }

  const CellSlot& slot(std::int32_t number) const { return tree_.slots()[at(number)]; }

  bool allTerminating(std::int32_t leaf) const {
    bool any = false;
    for (const std::int32_t corner : tree_.corners(leaf)) {
      const auto number = space_.lattice.indexOf(slot(corner).point);
      if (!number || !isSolved(space_.points[*number].tag)) continue;
      any = true;
      if (space_.points[*number].tag != Tag::terminating) return false;
    }
    return any;
  }

  /// True if it is useless to split the leaf, because a jump between branches crosses it: the jump
  /// would stay where it is.
  ///
  /// On the coarsest level, inconsistent edges count as jumps. On finer levels, suspect edges do
  /// too: one split tells whether a suspect edge has a jump. For a finger, both tests begin one
  /// level later: tissue can stiffen and soften again between the ends of a coarse edge, which
  /// looks like a jump.
  bool isAtJump(std::int32_t leaf) const {
    const int level = tree_.leaves()[at(leaf)].level, first = space_.patch.finger ? 1 : 0;
    if (level < first) return false;
    return anyEdge(tree_.corners(leaf), [&](std::int32_t a, std::int32_t b) {
      return contains(level == first ? jumps_ : suspects_, slot(a).number, slot(b).number);
    });
  }

  /// True if the leaf of a finger has a failed corner and comes from a split, unless
  /// endsBesideRest() is true. Beyond such a leaf lies a region without solved positions: behind a
  /// fold, or above the forces that matter. One split locates the border of this region. Smaller
  /// cells would trace the border more closely, but each costs many failing transitions. Applies
  /// only to fingers, because at sharp rims such regions take up to half of the ball.
  bool isAtEnd(std::int32_t leaf) const {
    return space_.patch.finger && tree_.leaves()[at(leaf)].level > 0 && hasFailedCorner(leaf) &&
           !endsBesideRest(leaf);
  }

  /// True if the leaf of a finger has an edge from the rest position to a failed corner. This
  /// happens if the tissue is stiff relative to the spacing. Nearly everything that a hand feels
  /// lies within this leaf, although rest may be its only solved corner. The leaf is then split as
  /// often as levels allow.
  bool endsBesideRest(std::int32_t leaf) const {
    if (!space_.patch.finger) return false;
    const LeafCorners& corners = tree_.corners(leaf);
    for (std::size_t c = 0; c < 8; ++c)
      if (squaredNorm(slot(corners[c]).point) == 0)
        return std::ranges::any_of(std::array<std::size_t, 3>{1, 2, 4}, [&](std::size_t along) {
          return hasFailed(corners[c ^ along]);
        });
    return false;
  }

  bool hasFailedCorner(std::int32_t leaf) const {
    return std::ranges::any_of(tree_.corners(leaf),
                               [this](std::int32_t corner) { return hasFailed(corner); });
  }

  bool hasFailed(std::int32_t corner) const {
    const auto number = space_.lattice.indexOf(slot(corner).point);
    return number && !isSolved(space_.points[*number].tag);
  }

  std::vector<LatticePoint> untriedCorners(std::int32_t leaf) const {
    std::vector<LatticePoint> untried;
    for (const std::int32_t corner : tree_.corners(leaf))
      if (slot(corner).kind == SlotKind::ghost && !space_.lattice.indexOf(slot(corner).point) &&
          tree_.displacement(corner).norm() <= tree_.radius() + reach_outside * tree_.edge(leaf))
        untried.push_back(slot(corner).point);
    return untried;
  }

  /// Adds the corners that the leaves will have after these splits, if they lie in the ball, are
  /// not hanging vertices, and were never tried.
  void addNewCorners(const std::vector<LatticeCell>& splits, std::set<LatticePoint>& points) const {
    if (splits.empty()) return;
    SpaceTable after = space_;
    after.splits.insert(after.splits.end(), splits.begin(), splits.end());
    std::ranges::sort(after.splits, coarserFirst);
    const CellTree tree(after);
    for (std::size_t s = 0; s < tree.slots().size(); ++s) {
      const CellSlot& corner = tree.slots()[s];
      if (corner.kind == SlotKind::ghost && !space_.lattice.indexOf(corner.point) &&
          tree.displacement(static_cast<std::int32_t>(s)).norm() <= tree.radius() * (1 + 1e-9))
        points.insert(corner.point);
    }
  }

  const SpaceTable& space_;
  const Accuracy& accuracy_;
  const double max_force_;
  const CellTree tree_;
  const std::vector<LatticeEdge> jumps_, suspects_;
  std::vector<EnergyJet> jets_;
  /// Leaves that are not accurate enough, or for which endsBesideRest() is true, each with its
  /// largest ratio of the likely error to the allowed error.
  std::vector<std::pair<std::int32_t, double>> poor_;
  double kept_ = 0, samples_ = 0;
};

}  // namespace

Refinement nextRefinement(const SpaceTable& space, const Scene& scene) {
  if (!scene.accuracy.adaptive())
    throw failure("active node {}: cannot refine a scene without accuracy.force_error",
                  space.patch.name);
  if (space.lattice.divisions() != lattice_divisions)
    throw failure("active node {}: its lattice has {} divisions, but refinement needs {}",
                  space.patch.name, space.lattice.divisions(), lattice_divisions);
  return CellInspection(space, scene).refine();
}

}  // namespace palpate
