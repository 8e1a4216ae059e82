#pragma once

#include <set>

#include "common/problem/problem.hpp"
#include "common/space/result_key.hpp"
#include "common/space/space_table.hpp"
#include "scheduler/plan/compact_points.hpp"
#include "scheduler/plan/frontier.hpp"

namespace palpate {

/// The stage of a plan. A stage begins when the stage before it has no open transition left.
enum class Stage : std::uint8_t {
  lattice,   ///< points of the uniform lattice (Frontier)
  branches,  ///< ends of inconsistent edges, each solved again from the other end
  cells,     ///< points that refinement asked for
  probes,    ///< positions off the lattice, which measure the error
  complete,
};

/// Returns "lattice", "branches", "cells", "probes" or "complete".
std::string_view name(Stage stage);

/// Number of equal steps into which a transition is divided in the stage branches. Small steps
/// follow a branch of equilibria where one long step may jump to another branch.
inline constexpr std::int32_t steps_of_retry = 4;
/// Limit on the number of consecutive rounds of the stage branches.
inline constexpr int max_branch_rounds = 8;

/// Returns the dataset row of a point that was solved from `parent`. `fields` identifies the
/// point's nodal fields. `max_force` is workspace.max_force, N.
PointRecord solvedPoint(std::int32_t parent, const Outcome& outcome, const ContentId& fields,
                        double max_force);

/// Decides which transitions of one active node are solved next, from the scene and the recorded
/// outcomes alone. Neither time, nor workers, nor the order of arrival has an influence. The
/// configuration space is therefore a function of the outcomes of the transitions. A restart that
/// records the known outcomes again continues exactly where the last run stopped.
///
/// - lattice: the uniform lattice (Frontier).
/// - branches: each end of an inconsistent edge (inconsistentEdges) is solved again from the other
///   end, in steps_of_retry steps. A point keeps the equilibrium of least energy that was found for
///   it, because a hand that comes from rest ends in that state. This is repeated as long as some
///   point changes, at most max_branch_rounds times.
/// - cells: only in adaptive scenes. nextRefinement asks for points, and each point is tried from
///   the nearest expandable points, one after the other, in at most maxAttempts() attempts. Then
///   branches and cells follow again, until the accuracy is reached or nothing can improve it.
/// - probes: probesIn() positions of the ball that are not in the lattice (probePositions), tried
///   like the points of the stage cells.
///
/// A plan with ActivePatch::probe only measures the error at one place of a finger's area. Its
/// lattice is the origin alone, and its only probe is reached from the origin in steps of about
/// half a spacing.
///
/// Points are numbered as in the lattice; probes follow. Copyable, one thread at a time.
class SpacePlan {
 public:
  SpacePlan(const Problem& problem, std::uint32_t space);

  /// Returns the transition with this key; none if the plan does not have both points (yet).
  std::optional<Transition> find(const ResultKey& key) const;
  ResultKey keyOf(const Transition& transition) const;

  /// Returns the transitions that became ready since the last call. Each stays open until it is
  /// recorded.
  std::vector<Transition> takeReady();
  bool isOpen(const Transition& transition) const;
  /// Returns true if the outcome of this transition was recorded.
  bool isRecorded(const Transition& transition) const;
  /// Returns the number of steps that a worker divides this open transition into; usually 1.
  std::int32_t stepsOf(const Transition& transition) const;
  /// Records the outcome of an open transition. If it converged, `fields` identifies its nodal
  /// fields. Throws if the transition is not open.
  void record(const Transition& transition, const Outcome& outcome, const ContentId& fields);

  Stage stage() const { return stage_; }
  /// Number of stages begun after the stage `lattice`. A stage that is repeated is counted each
  /// time. A stage begins only when no transition is open, so all transitions of earlier stages are
  /// recorded by then.
  int stagesBegun() const { return stages_begun_; }
  bool complete() const { return stage_ == Stage::complete; }
  /// Number of transitions that are ready and not recorded.
  std::int32_t openCount() const;
  /// False when refinement will add no more points.
  bool mayGrow() const { return may_grow_; }
  /// Number of points that refinement will probably ask for after its last request
  /// (Refinement::later); none before its first request.
  const std::optional<double>& laterPoints() const { return later_points_; }

  /// All positions: the points of the lattice, then the probes.
  const Lattice& positions() const { return positions_; }
  std::int32_t size() const { return positions_.size(); }
  /// One past the number of the last point; probes are numbered from here.
  std::int32_t endOfPoints() const { return first_probe_ < 0 ? size() : first_probe_; }
  /// Recorded results of points and probes. A point is failed once no further attempt will be made.
  const CompactPoints& points() const { return points_; }

  const ActivePatch& patch() const { return problem_->active[space_]; }
  const std::vector<LatticeCell>& splits() const { return splits_; }
  /// Returns a copy of the dataset's rows as far as they are known.
  SpaceTable table() const;

 private:
  /// The parents from which a target is tried.
  struct Pursuit {
    std::vector<std::int32_t> parents;
    std::size_t tried = 0;
    bool every_parent = false;  ///< true: tries all parents; false: stops at a success
  };

  void recordInPursuit(const Transition& transition, bool converged, PointRecord found);
  void pursue(std::int32_t target, std::vector<std::int32_t> parents, bool every_parent);
  void giveUp(std::int32_t target);
  std::int32_t addPosition(const LatticePoint& position);
  std::vector<std::int32_t> parentsNear(const LatticePoint& position) const;

  void advanceStage();
  void beginBranches();
  bool keepLeastEnergy();
  void beginCells();
  void beginProbes();

  const Problem* problem_;
  std::uint32_t space_;
  Lattice positions_;
  std::int32_t first_probe_ = -1;  ///< -1 before the stage probes
  std::vector<LatticeCell> splits_;
  CompactPoints points_;
  Frontier frontier_;  ///< for the stage lattice
  /// Further equilibria that the current round of branches found, by point.
  std::map<std::int32_t, std::vector<PointRecord>> alternatives_;
  /// Recorded transitions that converged, but whose equilibrium is not the one kept at the target:
  /// the target had another one already, or one of less energy replaced it later.
  std::set<Transition> passed_over_;
  std::map<std::int32_t, Pursuit> pursuits_;  ///< open work after the stage lattice, by target
  std::vector<Transition> ready_;
  Stage stage_ = Stage::lattice;
  int stages_begun_ = 0;
  int branch_round_ = 0;
  bool may_grow_;
  std::optional<double> later_points_;
};

/// Returns the rows of several plans, which must outlive the rows and stay unchanged meanwhile.
SpaceRowsList rowsOf(const std::vector<SpacePlan>& plans);

/// Returns the transition with this key from the plan of its space. Returns none if the space does
/// not exist or if SpacePlan::find() returns none.
std::optional<Transition> findIn(const std::vector<SpacePlan>& plans, const ResultKey& key);

/// Returns `count` positions of the workspace ball for probes, from a low-discrepancy sequence
/// (Roberts' R3). No lattice point can lie at one of them. The coordinates are those of `lattice`,
/// whose divisions() must exceed 1. With `part`, returns only positions in that part of the ball.
std::vector<LatticePoint> probePositions(const Lattice& lattice, std::int32_t count,
                                         const PushedPart& part = {});

}  // namespace palpate
