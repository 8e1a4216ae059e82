#pragma once

#include <set>

#include "common/problem/problem.hpp"
#include "common/space/result_key.hpp"
#include "common/space/space_table.hpp"
#include "scheduler/plan/compact_points.hpp"
#include "scheduler/plan/frontier.hpp"

namespace palpate {

/// The stage of a plan. A stage begins when the one before it has nothing open.
enum class Stage : std::uint8_t {
  lattice,   ///< the uniform lattice, by Frontier
  branches,  ///< both ends of inconsistent edges, each solved from the other
  cells,     ///< points that refinement asked for
  probes,    ///< held-out positions
  complete,
};

/// Returns "lattice", "branches", "cells", "probes" or "complete".
std::string_view name(Stage stage);

/// Steps of a transition in the stage branches. Equal small steps follow a branch where one long
/// step may jump to another.
inline constexpr std::int32_t steps_of_retry = 4;
/// Limit on the consecutive rounds of the stage branches.
inline constexpr int max_branch_rounds = 8;

/// Returns the row of a point that was solved from `parent`. `fields` identifies its nodal fields;
/// `max_force` is the workspace's, N.
PointRecord solvedPoint(std::int32_t parent, const Outcome& outcome, const ContentId& fields,
                        double max_force);

/// Decides which transitions one active node's build solves next, from the scene and the recorded
/// outcomes alone. It uses no clock, no workers and no order of arrival. The configuration space is
/// therefore a function of the outcomes of the transitions. A restart that records the known
/// outcomes again continues exactly where the last run stopped.
///
/// - lattice: the uniform lattice (Frontier).
/// - branches: each end of an inconsistent edge (inconsistentEdges) is solved again from the other
///   end, in steps_of_retry steps. The equilibrium of least energy found for a point is kept: a
///   hand that comes from rest ends in that state. This is repeated while a point changes, at most
///   max_branch_rounds times.
/// - cells: an adaptive scene asks nextRefinement for points. Each is tried from the nearest
///   expandable points, one after the other, in at most maxAttempts() attempts. Then branches and
///   cells follow again, until the accuracy is reached or nothing can improve it.
/// - probes: probesIn() held-out positions of the ball (probePositions), tried like the points of
///   cells.
///
/// If a finger's area is measured (ActivePatch::probe), the lattice is the origin alone. The only
/// probe is reached from the origin in steps of about half a spacing.
///
/// Points are numbered as in the lattice; probes follow. Copyable, one thread at a time.
class SpacePlan {
 public:
  SpacePlan(const Problem& problem, std::uint32_t space);

  /// Returns a transition of this plan; none if one of its points does not exist (yet).
  std::optional<Transition> find(const ResultKey& key) const;
  ResultKey keyOf(const Transition& transition) const;

  /// Returns the transitions that became ready since the last call. Each stays open until it is
  /// recorded.
  std::vector<Transition> takeReady();
  bool isOpen(const Transition& transition) const;
  /// Returns true if record() took the outcome of this transition.
  bool isRecorded(const Transition& transition) const;
  /// Returns the number of steps that a worker divides this open transition into; usually 1.
  std::int32_t stepsOf(const Transition& transition) const;
  /// Records the outcome of an open transition. `fields` identifies its nodal fields if it
  /// converged. Throws if the transition is not open.
  void record(const Transition& transition, const Outcome& outcome, const ContentId& fields);

  Stage stage() const { return stage_; }
  /// Number of stages begun since the lattice; a stage that begins again counts again. Everything
  /// that was open before a stage began has been recorded.
  int stagesBegun() const { return stages_begun_; }
  bool complete() const { return stage_ == Stage::complete; }
  /// Number of transitions that are ready and not recorded.
  std::int32_t openCount() const;
  /// False when refinement will add no more points.
  bool mayGrow() const { return may_grow_; }
  /// Likely number of points that refinement will ask for after the points of its last request
  /// (Refinement::later); none before its first request.
  const std::optional<double>& laterPoints() const { return later_points_; }

  /// All positions: the points of the lattice, then the probes.
  const Lattice& positions() const { return positions_; }
  std::int32_t size() const { return positions_.size(); }
  /// Number of the first probe, one past the last point.
  std::int32_t endOfPoints() const { return first_probe_ < 0 ? size() : first_probe_; }
  /// Recorded results of points and probes. A point is failed as soon as nothing more will be
  /// tried.
  const CompactPoints& points() const { return points_; }
  PointRecord point(std::int32_t number) const { return points_.record(number); }
  /// Failed attempts in the order in which they were made.
  const std::vector<FailedAttempt>& attempts(std::int32_t number) const {
    return points_.attempts(number);
  }

  const ActivePatch& patch() const { return problem_->active[space_]; }
  const std::vector<LatticeCell>& splits() const { return splits_; }
  /// Returns a copy of the rows of the dataset as far as they are known (PlanRows).
  SpaceTable table() const;

 private:
  /// The points from which a target is tried.
  struct Pursuit {
    std::vector<std::int32_t> parents;
    std::size_t tried = 0;
    bool every_parent = false;  ///< tries all parents; otherwise stops at the first success
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
  /// Other equilibria of points that this round of branches found.
  std::map<std::int32_t, std::vector<PointRecord>> alternatives_;
  /// Recorded transitions that neither failed nor gave a point its current equilibrium.
  std::set<Transition> passed_over_;
  std::map<std::int32_t, Pursuit> pursuits_;  ///< by target; open work after the stage lattice
  std::vector<Transition> ready_;
  Stage stage_ = Stage::lattice;
  int stages_begun_ = 0;
  int branch_round_ = 0;
  bool may_grow_;
  std::optional<double> later_points_;
};

/// Presents a plan as the rows of a dataset. `plan` must outlive this object and stay unchanged
/// meanwhile.
class PlanRows : public SpaceRows {
 public:
  explicit PlanRows(const SpacePlan& plan) : plan_(plan) {}
  const ActivePatch& patch() const override { return plan_.patch(); }
  const Lattice& lattice() const override { return plan_.positions(); }
  const std::vector<LatticeCell>& splits() const override { return plan_.splits(); }
  std::int32_t points() const override { return plan_.endOfPoints(); }
  PointRecord point(std::int32_t n) const override { return plan_.point(n); }
  Tag tag(std::int32_t n) const override { return plan_.points().tag(n); }
  const ToolEquilibrium* equilibrium(std::int32_t n) const override {
    return isSolved(tag(n)) ? &plan_.points().equilibrium(n) : nullptr;
  }
  std::size_t attempts() const override;
  void eachAttempt(const VisitAttempt& visit) const override;
  std::int32_t probes() const override { return plan_.size() - plan_.endOfPoints(); }
  Probe probe(std::int32_t n) const override;

 private:
  const SpacePlan& plan_;
};

/// Returns the rows of several plans, which must outlive them.
SpaceRowsList rowsOf(const std::vector<SpacePlan>& plans);

/// Returns a transition of the plan of its space; none if there is no such space or
/// SpacePlan::find() returns none.
std::optional<Transition> findIn(const std::vector<SpacePlan>& plans, const ResultKey& key);

/// Returns `count` positions of the workspace ball for probes: a low-discrepancy sequence (Roberts'
/// R3). No lattice can have a point there. The coordinates are those of `lattice`, which must have
/// divisions. With `part`, only positions in that part of the ball.
std::vector<LatticePoint> probePositions(const Lattice& lattice, std::int32_t count,
                                         const PushedPart& part = {});

}  // namespace palpate
