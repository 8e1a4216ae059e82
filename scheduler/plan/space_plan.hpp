#pragma once

#include <set>

#include "common/problem/problem.hpp"
#include "common/space/result_key.hpp"
#include "common/space/space_table.hpp"
#include "scheduler/plan/compact_points.hpp"
#include "scheduler/plan/frontier.hpp"

namespace palpate {

/// What a plan is working on. A stage begins when the one before it has nothing open.
enum class Stage : std::uint8_t {
  lattice,   ///< the uniform lattice, by the frontier
  branches,  ///< ends of inconsistent edges, from the other end
  cells,     ///< points that refinement asked for
  probes,    ///< held-out positions
  complete,
};

/// "lattice", "branches", "cells", "probes" or "complete".
std::string_view name(Stage stage);

/// A continuation in equal steps follows a branch where one long step may jump to another.
inline constexpr std::int32_t steps_of_retry = 4;
/// Points are solved anew at most so often because an edge was inconsistent.
inline constexpr int max_branch_rounds = 8;

/// The row of a point that was solved from `parent`; `fields` names its nodal fields. `max_force`
/// of the scene's workspace, N.
PointRecord solvedPoint(std::int32_t parent, const Outcome& outcome, const ContentId& fields,
                        double max_force);

/// Where one active node's build has to go, from the scene and the recorded outcomes alone: no
/// clock, no workers, no order of arrival. So the whole configuration space is a function of what
/// the transitions give, and a restart that records the known outcomes again is exactly where the
/// last run was.
///
/// - lattice: the uniform lattice (Frontier).
/// - branches: each end of an inconsistent edge (inconsistentEdges) is solved again from the other
///   end, in steps_of_retry steps. Of all equilibria found for a point the one of least energy is
///   kept: the state that a hand coming from rest ends in. Repeated while that changes something.
/// - cells: an adaptive scene asks nextRefinement for points; each is tried from the nearest
///   expandable points, one after the other, maxAttempts() at most; then branches again,
///   and so on until the accuracy is reached or nothing can improve it.
/// - probes: probesIn() held-out positions of the ball (probePositions), tried like those.
///
/// Where a finger's area is measured (ActivePatch::probe) the lattice is the origin, and there is
/// one probe, which is reached from there in steps of about half a spacing.
///
/// Points are numbered as in the lattice; probes follow. Copyable, one thread at a time.
class SpacePlan {
 public:
  SpacePlan(const Problem& problem, std::uint32_t space);

  /// A transition of this plan by its points; nothing when one of them is no point of it (yet).
  std::optional<Transition> find(const ResultKey& key) const;
  ResultKey keyOf(const Transition& transition) const;

  /// The transitions that became ready since the last call. Each stays open until it is recorded.
  std::vector<Transition> takeReady();
  bool isOpen(const Transition& transition) const;
  /// It was open once, and record() took its outcome.
  bool isRecorded(const Transition& transition) const;
  /// Steps that a worker divides this open transition into, 1 as a rule.
  std::int32_t stepsOf(const Transition& transition) const;
  /// Records the outcome of an open transition; `fields` names its nodal fields when it converged.
  /// Error when it is not open.
  void record(const Transition& transition, const Outcome& outcome, const ContentId& fields);

  Stage stage() const { return stage_; }
  /// Stages that have begun since the lattice, the same one again counted again: all that was open
  /// before was recorded before.
  int stagesBegun() const { return stages_begun_; }
  bool complete() const { return stage_ == Stage::complete; }
  /// Transitions that are ready and not recorded.
  std::int32_t openCount() const;
  /// More points may still be asked for.
  bool mayGrow() const { return may_grow_; }
  /// How many points refinement is likely to ask for after those that it has asked for
  /// (Refinement::later); nothing before it has asked the first time.
  const std::optional<double>& laterPoints() const { return later_points_; }

  /// All positions: points of the lattice, then probes.
  const Lattice& positions() const { return positions_; }
  std::int32_t size() const { return positions_.size(); }
  /// Where the probes begin.
  std::int32_t endOfPoints() const { return first_probe_ < 0 ? size() : first_probe_; }
  /// What is known of a point or probe; failed as soon as nothing more will be tried.
  const CompactPoints& points() const { return points_; }
  PointRecord point(std::int32_t number) const { return points_.record(number); }
  /// Attempts that failed, in the order of trying.
  const std::vector<FailedAttempt>& attempts(std::int32_t number) const {
    return points_.attempts(number);
  }

  const ActivePatch& patch() const { return problem_->active[space_]; }
  const std::vector<LatticeCell>& splits() const { return splits_; }
  /// The rows of the dataset, as far as they are known (PlanRows), copied.
  SpaceTable table() const;

 private:
  /// A target and the points to try it from.
  struct Pursuit {
    std::vector<std::int32_t> parents;
    std::size_t tried = 0;
    bool every_parent = false;  ///< else until one succeeds
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
  std::int32_t first_probe_ = -1;  ///< -1 before there are probes
  std::vector<LatticeCell> splits_;
  CompactPoints points_;
  Frontier frontier_;  ///< of the lattice stage
  /// Other equilibria of points, found in this round of branches.
  std::map<std::int32_t, std::vector<PointRecord>> alternatives_;
  /// Recorded, and neither a failed attempt nor what a point has its equilibrium from.
  std::set<Transition> passed_over_;
  std::map<std::int32_t, Pursuit> pursuits_;  ///< by target; what is open after the lattice
  std::vector<Transition> ready_;
  Stage stage_ = Stage::lattice;
  int stages_begun_ = 0;
  int branch_round_ = 0;
  bool may_grow_;
  std::optional<double> later_points_;
};

/// What a plan knows, as the rows of a dataset. `plan` must outlive it, and not change meanwhile.
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

/// Those of several.
SpaceRowsList rowsOf(const std::vector<SpacePlan>& plans);

/// A transition of the plan of its space; nothing when there is none, or SpacePlan::find() says so.
std::optional<Transition> findIn(const std::vector<SpacePlan>& plans, const ResultKey& key);

/// `count` positions of the workspace ball for probes: a low-discrepancy sequence (Roberts' R3),
/// never on a point that a lattice could have. Coordinates as in `lattice`, which needs divisions.
/// Of a part of the ball only where one is given.
std::vector<LatticePoint> probePositions(const Lattice& lattice, std::int32_t count,
                                         const PushedPart& part = {});

}  // namespace palpate
