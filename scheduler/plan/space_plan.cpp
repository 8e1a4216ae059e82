#include "scheduler/plan/space_plan.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"
#include "common/interpolation/branch_check.hpp"
#include "scheduler/plan/refinement.hpp"

namespace palpate {
namespace {

/// Largest distance of a parent from its target, in spacings. A transition from farther away would
/// not join neighbours.
constexpr double farthest_parent = 2;

/// Two equilibria with a relative energy difference below this are the same equilibrium, within the
/// tolerance of Newton's method.
constexpr double same_energy = 1e-7;

std::int64_t squaredDistance(const LatticePoint& a, const LatticePoint& b) {
  return squaredNorm({a[0] - b[0], a[1] - b[1], a[2] - b[2]});
}

/// Calls visit(number) for the points of the uniform lattice in a cube around `position`. The cube
/// contains every point within farthest_parent.
template <class Visit>
void forEachUniformNear(const Lattice& lattice, const LatticePoint& position, const Visit& visit) {
  const std::int32_t spacing = lattice.divisions();
  constexpr auto reach = static_cast<std::int32_t>(farthest_parent);
  LatticePoint first;  // lowest corner of the cube, a multiple of the spacing
  for (std::size_t axis = 0; axis < 3; ++axis)
    first[axis] = (position[axis] / spacing - reach - 1) * spacing;
  constexpr std::int32_t side = 2 * reach + 3;
  for (std::int32_t i = 0; i < side; ++i)
    for (std::int32_t j = 0; j < side; ++j)
      for (std::int32_t k = 0; k < side; ++k) {
        const auto n = lattice.indexOf(
            {first[0] + i * spacing, first[1] + j * spacing, first[2] + k * spacing});
        if (n && *n < lattice.uniformSize()) visit(*n);
      }
}

/// Returns the lattice position of a displacement. Rounds towards rest, so the position never
/// leaves the ball.
LatticePoint positionOf(const Eigen::Vector3d& displacement, double unit) {
  LatticePoint position{};
  for (int axis = 0; axis < 3; ++axis)
    position[axis] = static_cast<std::int32_t>(displacement[axis] / unit);
  return position;
}

/// Presents a plan as the rows of a dataset.
class PlanRows : public SpaceRows {
 public:
  explicit PlanRows(const SpacePlan& plan) : plan_(plan) {}
  const ActivePatch& patch() const override { return plan_.patch(); }
  const Lattice& lattice() const override { return plan_.positions(); }
  const std::vector<LatticeCell>& splits() const override { return plan_.splits(); }
  std::int32_t points() const override { return plan_.endOfPoints(); }
  PointRecord point(std::int32_t n) const override { return plan_.points().record(n); }
  Tag tag(std::int32_t n) const override { return plan_.points().tag(n); }
  const ToolEquilibrium* equilibrium(std::int32_t n) const override {
    return isSolved(tag(n)) ? &plan_.points().equilibrium(n) : nullptr;
  }
  void eachAttempt(const VisitAttempt& visit) const override {
    for (std::int32_t n = 0; n < points(); ++n)
      for (const FailedAttempt& attempt : plan_.points().attempts(n)) visit(attempt);
  }
  std::int32_t probes() const override { return plan_.size() - plan_.endOfPoints(); }
  Probe probe(std::int32_t n) const override {
    PALPATE_ASSERT(n >= 0 && n < probes(), "the number of the probe must exist");
    const std::int32_t number = points() + n;
    return {lattice().displacement(number), point(number)};
  }

 private:
  const SpacePlan& plan_;
};

}  // namespace

std::string_view name(Stage stage) {
  constexpr std::array<std::string_view, 5> names = {"lattice", "branches", "cells", "probes",
                                                     "complete"};
  return names.at(static_cast<std::size_t>(stage));
}

PointRecord solvedPoint(std::int32_t parent, const Outcome& outcome, const ContentId& fields,
                        double max_force) {
  const Configuration& found = outcome.configuration();
  return {.tag = tagOf(found.equilibrium.force.norm(), max_force),
          .parent = parent,
          .equilibrium = found.equilibrium,
          .residual = found.residual,
          .cost = outcome.cost,
          .fields = fields};
}

SpacePlan::SpacePlan(const Problem& problem, std::uint32_t space)
    : problem_(&problem),
      space_(space),
      positions_(uniformLattice(problem.scene, problem.active[space])),
      points_(positions_.size()),
      frontier_({positions_, points_}, maxAttempts(problem.active[space])),
      may_grow_(problem.scene.accuracy.adaptive() && !problem.active[space].probe) {
  PALPATE_ASSERT(space < problem.active.size(), "the active node of a plan must exist");
}

std::optional<Transition> SpacePlan::find(const ResultKey& key) const {
  PALPATE_ASSERT(key.space == space_, "a transition must belong to the space of its plan");
  const auto target = positions_.indexOf(key.target), parent = positions_.indexOf(key.parent);
  return target && parent ? std::optional(Transition{*target, *parent}) : std::nullopt;
}

ResultKey SpacePlan::keyOf(const Transition& transition) const {
  return {space_, positions_.point(transition.target), positions_.point(transition.parent)};
}

std::vector<Transition> SpacePlan::takeReady() {
  std::vector<Transition> ready = frontier_.takeReady();
  ready.insert(ready.end(), ready_.begin(), ready_.end());
  ready_.clear();
  return ready;
}

bool SpacePlan::isOpen(const Transition& transition) const {
  if (stage_ == Stage::lattice) return frontier_.isOpen(transition);
  const auto found = pursuits_.find(transition.target);
  return found != pursuits_.end() &&
         found->second.parents[found->second.tried] == transition.parent;
}

bool SpacePlan::isRecorded(const Transition& transition) const {
  const auto& [target, parent] = transition;
  if (target < 0 || target >= size()) return false;
  return (isSolved(points_.tag(target)) && points_.parent(target) == parent) ||
         std::ranges::find(points_.attempts(target), parent, &FailedAttempt::parent) !=
             points_.attempts(target).end() ||
         passed_over_.contains(transition);
}

std::int32_t SpacePlan::stepsOf(const Transition& transition) const {
  PALPATE_ASSERT(isOpen(transition), "the transition must be requested and have no result");
  if (stage_ == Stage::branches) return steps_of_retry;
  if (stage_ != Stage::probes || !problem_->active[space_].probe) return 1;
  const double distance = positions_.displacement(transition.target).norm();
  return static_cast<std::int32_t>(std::ceil(distance / (positions_.spacing() / 2)));
}

std::int32_t SpacePlan::openCount() const {
  return stage_ == Stage::lattice ? frontier_.openCount()
                                  : static_cast<std::int32_t>(pursuits_.size());
}

void SpacePlan::record(const Transition& transition, const Outcome& outcome,
                       const ContentId& fields) {
  if (!isOpen(transition))
    throw failure(
        "space {}: transition to point {} from point {} is recorded but was not requested", space_,
        transition.target, transition.parent);
  // Record failed retries of solved points too: users see them (`palpate explain`), and
  // beginBranches() does not repeat them.
  if (!outcome.converged())
    points_.addAttempt({transition.target, transition.parent, outcome.failure()});
  PointRecord found;
  if (outcome.converged())
    found = solvedPoint(transition.parent, outcome, fields, problem_->scene.workspace.max_force);
  if (stage_ == Stage::lattice) {
    if (outcome.converged()) points_.solve(transition.target, found);
    frontier_.record(transition, {positions_, points_});
  } else {
    recordInPursuit(transition, outcome.converged(), std::move(found));
  }
  while (!complete() && openCount() == 0) advanceStage();
}

void SpacePlan::recordInPursuit(const Transition& transition, bool converged, PointRecord found) {
  const auto place = pursuits_.find(transition.target);
  Pursuit& pursuit = place->second;
  PALPATE_ASSERT(pursuit.tried < pursuit.parents.size(),
                 "the point must have a start point left to try");
  ++pursuit.tried;
  // Compare alternatives only when the round ends, so that the order of arrival has no influence.
  if (converged && pursuit.every_parent) {
    alternatives_[transition.target].push_back(std::move(found));
    passed_over_.insert(transition);
  } else if (converged) {
    points_.solve(transition.target, found);
  }
  const bool over = (converged && !pursuit.every_parent) || pursuit.tried == pursuit.parents.size();
  if (!over) return ready_.push_back({transition.target, pursuit.parents[pursuit.tried]});
  if (!isSolved(points_.tag(transition.target))) giveUp(transition.target);
  pursuits_.erase(place);
}

void SpacePlan::pursue(std::int32_t target, std::vector<std::int32_t> parents, bool every_parent) {
  PALPATE_ASSERT(!pursuits_.contains(target), "attempts at a point must begin only once per stage");
  if (parents.empty()) return giveUp(target);
  ready_.push_back({target, parents.front()});
  pursuits_[target] = {std::move(parents), 0, every_parent};
}

/// Marks a point as failed. Its cause is that of the attempt that got furthest (the first one, if
/// there are several), because that attempt says most about the obstacle.
void SpacePlan::giveUp(std::int32_t target) {
  PALPATE_ASSERT(!isSolved(points_.tag(target)), "a solved point must not be marked as failed");
  const std::vector<FailedAttempt>& tries = points_.attempts(target);
  if (tries.empty()) return points_.fail(target, Cause::unreachable);
  const auto furthest = std::ranges::max_element(
      tries, {}, [](const FailedAttempt& attempt) { return attempt.failure.step_reached; });
  points_.fail(target, furthest->failure.cause);
}

std::int32_t SpacePlan::addPosition(const LatticePoint& position) {
  positions_.add(position);
  points_.add();
  PALPATE_ASSERT(positions_.size() == points_.size(), "each position must have a record");
  return positions_.size() - 1;
}

/// Returns the nearest expandable points, at most maxAttempts() of them. Equally near points are
/// sorted by their distance from the origin, then by number.
std::vector<std::int32_t> SpacePlan::parentsNear(const LatticePoint& position) const {
  using Candidate = std::tuple<std::int64_t, std::int64_t, std::int32_t>;
  const double reach = farthest_parent * positions_.divisions();
  std::vector<Candidate> candidates;
  const auto consider = [&](std::int32_t n) {
    if (points_.tag(n) != Tag::expandable) return;
    const std::int64_t distance = squaredDistance(positions_.point(n), position);
    if (static_cast<double>(distance) <= reach * reach)
      candidates.emplace_back(distance, squaredNorm(positions_.point(n)), n);
  };
  forEachUniformNear(positions_, position, consider);
  // Probes are never parents: the space must not depend on the measurement of its error.
  for (std::int32_t n = positions_.uniformSize(); n < endOfPoints(); ++n) consider(n);
  const auto wanted =
      std::min<std::ptrdiff_t>(std::ssize(candidates), maxAttempts(problem_->active[space_]));
  std::ranges::partial_sort(candidates, candidates.begin() + wanted);
  std::vector<std::int32_t> parents;
  for (const auto& [distance, norm, n] : std::span(candidates).first(wanted)) parents.push_back(n);
  return parents;
}

/// Moves on from a stage that has no open transition. The next stage may have nothing to do either.
void SpacePlan::advanceStage() {
  ++stages_begun_;
  switch (stage_) {
    case Stage::lattice:
      PALPATE_ASSERT(frontier_.complete(), "a lattice without open transitions must be complete");
      for (std::int32_t n = 0; n < size(); ++n)
        if (points_.tag(n) == Tag::unknown) giveUp(n);
      stage_ = Stage::branches;
      return beginBranches();
    case Stage::branches:
      if (keepLeastEnergy() && branch_round_ < max_branch_rounds) return beginBranches();
      stage_ = Stage::cells;
      return beginCells();
    case Stage::cells:
      // The new points may lie on other branches than the old points around them.
      branch_round_ = 0;
      stage_ = may_grow_ ? Stage::branches : Stage::probes;
      return may_grow_ ? beginBranches() : beginProbes();
    case Stage::probes: stage_ = Stage::complete; return;
    case Stage::complete: return;
  }
}

void SpacePlan::beginBranches() {
  ++branch_round_;
  std::map<std::int32_t, std::vector<std::int32_t>> retries;
  const auto retry = [&](std::int32_t target, std::int32_t parent) {
    if (points_.tag(parent) == Tag::expandable && !isRecorded({target, parent}))
      retries[target].push_back(parent);
  };
  // Either end may lie on the branch of higher energy. Only solving each end from the other one
  // tells which end it is.
  const auto equilibriumOf = [this](std::int32_t n) {
    return isSolved(points_.tag(n)) ? &points_.equilibrium(n) : nullptr;
  };
  for (const LatticeEdge& edge : inconsistentEdges(positions_, splits_, equilibriumOf)) {
    retry(edge.a, edge.b);
    retry(edge.b, edge.a);
  }
  for (auto& [target, parents] : retries) pursue(target, std::move(parents), true);
}

/// Gives each point its equilibrium of least energy. Returns true if a point changed.
bool SpacePlan::keepLeastEnergy() {
  bool changed = false;
  for (auto& [target, found] : std::exchange(alternatives_, {}))
    for (PointRecord& alternative : found) {
      const double energy = points_.equilibrium(target).energy;
      // If the energies are equal, keep the old equilibrium: otherwise the point could alternate
      // between two roundings of the same equilibrium.
      if (alternative.equilibrium.energy >= energy - same_energy * std::abs(energy)) continue;
      passed_over_.insert({target, points_.parent(target)});
      points_.solve(target, alternative);
      changed = true;
    }
  return changed;
}

void SpacePlan::beginCells() {
  // Refinement needs a solved origin.
  may_grow_ = may_grow_ && isSolved(points_.tag(0));
  if (!may_grow_) return;
  const Refinement refinement = nextRefinement(table(), problem_->scene);
  splits_.insert(splits_.end(), refinement.splits.begin(), refinement.splits.end());
  std::ranges::sort(splits_, coarserFirst);
  may_grow_ = !refinement.empty();
  later_points_ = refinement.later;
  // Choose all parents before adding the first new point, so that the order of points has no
  // influence.
  std::vector<std::pair<std::int32_t, std::vector<std::int32_t>>> targets;
  for (const LatticePoint& position : refinement.points) {
    std::vector<std::int32_t> parents = parentsNear(position);
    targets.emplace_back(addPosition(position), std::move(parents));
  }
  for (auto& [target, parents] : targets) pursue(target, std::move(parents), false);
}

void SpacePlan::beginProbes() {
  const ActivePatch& patch = problem_->active[space_];
  first_probe_ = size();  // parentsNear() considers only points before the probes
  if (patch.probe) {
    const std::int32_t target = addPosition(positionOf(*patch.probe, positions_.unit()));
    const bool from_rest = points_.tag(0) == Tag::expandable;
    return pursue(target, from_rest ? std::vector{0} : std::vector<std::int32_t>{}, false);
  }
  const std::vector<LatticePoint> positions =
      probePositions(positions_, probesIn(problem_->scene, space_),
                     patch.finger ? patch.finger->reach : PushedPart{});
  for (const LatticePoint& position : positions) {
    const std::int32_t target = addPosition(position);
    pursue(target, parentsNear(position), false);
  }
}

SpaceTable SpacePlan::table() const { return tableOf(PlanRows(*this)); }

SpaceRowsList rowsOf(const std::vector<SpacePlan>& plans) {
  SpaceRowsList rows;
  for (const SpacePlan& plan : plans) rows.push_back(std::make_unique<PlanRows>(plan));
  return rows;
}

std::optional<Transition> findIn(const std::vector<SpacePlan>& plans, const ResultKey& key) {
  return key.space < plans.size() ? plans[key.space].find(key) : std::nullopt;
}

std::vector<LatticePoint> probePositions(const Lattice& lattice, std::int32_t count,
                                         const PushedPart& part) {
  const double reach = lattice.radius() / lattice.unit();
  std::vector<LatticePoint> positions;
  for (std::int64_t n = 1; static_cast<std::int32_t>(positions.size()) < count; ++n) {
    const Eigen::Vector3d place = reach * (2 * evenlySpread(n).array() - 1);
    LatticePoint position{};
    // Use odd coordinates: the corners of cells larger than one unit have even ones.
    for (std::size_t axis = 0; axis < 3; ++axis)
      position[axis] = 2 * static_cast<std::int32_t>(std::floor(place[axis] / 2)) + 1;
    if (static_cast<double>(squaredNorm(position)) <= reach * reach &&
        part.contains(lattice.displacementOf(position)))
      positions.push_back(position);
  }
  return positions;
}

}  // namespace palpate
