#pragma once

#include <utility>

#include "scheduler/plan/compact_points.hpp"

namespace palpate {

/// To `target` from `parent`, lattice numbers. The origin is its own parent: it is solved from the
/// rest state.
struct Transition {
  std::int32_t target = -1;
  std::int32_t parent = -1;
  auto operator<=>(const Transition&) const = default;
};

/// expandable or terminating: the tag of a converged configuration with this |force| in a scene
/// with this workspace.max_force, both N.
constexpr Tag tagOf(double force, double max_force) {
  return force <= max_force ? Tag::expandable : Tag::terminating;
}

/// How often a point is tried before it is given up; half of it (rounded up) in round 0, where all
/// parents lie on one side of the point and tend to fail together, the rest from any side. A point
/// has 26 neighbours, and a failing transition costs ten converging ones.
inline constexpr int max_attempts_per_point = 8;
/// Of a finger: what three parents did not reach mostly lies behind a fold. A fourth reached one in
/// twelve of such points, and the attempts from there on took a quarter of a build.
inline constexpr int max_attempts_of_finger = 3;

/// Of a point of this active patch.
constexpr int maxAttempts(const ActivePatch& patch) {
  return patch.finger ? max_attempts_of_finger : max_attempts_per_point;
}

/// Decides which transitions of one uniform lattice are ready, from the lattice and what is
/// recorded of its points alone: no clock, no workers, no order of arrival. So tags, parents and
/// attempts are a function of what the transitions give, and a restart that records the known
/// endings again is exactly where the last run was.
///
/// - The origin is solved first.
/// - Round 0: the candidates of point x are its neighbours with a smaller squared norm, in the
///   order of Lattice::neighbours. They are walked in order. An expandable one is tried; a point
///   that is not settled yet makes x wait; a terminating or unreached one, or one that was tried,
///   is passed. When none is left, or half of the attempts are spent, x is settled as unreached.
/// - Round r >= 1 begins when every point is settled. The candidates of an unreached point are all
///   its neighbours that were expandable when the round began and that it has not tried. They are
///   tried one after the other until one succeeds or the attempts are spent.
/// - It is over when a round has nothing to try. Then unreached points are failed.
///
/// It keeps neither the lattice nor tags and attempts: its owner has them, and says so with each
/// call. Copyable value, one thread at a time.
class Frontier {
 public:
  /// A uniform lattice, and what is recorded of its points.
  struct Known {
    const Lattice& lattice;
    const CompactPoints& points;
  };
  /// Nothing is recorded yet.
  explicit Frontier(const Known& known, int max_attempts = max_attempts_per_point);

  /// The transitions that became ready since the last call. Each stays open until it is recorded.
  std::vector<Transition> takeReady() { return std::exchange(ready_, {}); }
  /// True for a transition that is ready and not recorded.
  bool isOpen(const Transition& transition) const;
  /// An open transition ended, and `points` say how: its target is solved, or has one failed
  /// attempt more. Error when it is not open.
  void record(const Transition& transition, const Known& known);

  /// Points that are unknown then are failed.
  bool complete() const { return complete_; }
  /// Transitions that are ready and not recorded.
  std::int32_t openCount() const { return open_count_; }

 private:
  /// waiting -> open -> reached, or -> unreached, which a later round may open again.
  enum class Phase : std::uint8_t { waiting, open, reached, unreached };
  struct Point {
    Phase phase = Phase::waiting;
    std::int32_t round_reached = 0;
    std::int32_t blocker = -1;  ///< open: the parent being tried; waiting: the point it waits for
  };

  void makeReady(std::int32_t target, std::int32_t parent);
  void settle(std::int32_t point);
  void advance(std::int32_t point, const Known& known);
  void releaseWaiting(const Known& known);
  void beginRound(const Known& known);

  std::size_t max_attempts_;
  std::vector<Point> points_;
  std::vector<Transition> ready_;
  /// In round 0: those whose waiting neighbours are to be looked at.
  std::vector<std::int32_t> newly_settled_;
  std::int32_t unsettled_ = 0;
  std::int32_t open_count_ = 0;
  int round_ = 0;
  bool complete_ = false;
};

}  // namespace palpate
