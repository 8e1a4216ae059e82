#pragma once

#include <utility>

#include "scheduler/plan/compact_points.hpp"

namespace palpate {

/// A solve of point `target` that starts from the equilibrium of point `parent`. Both are point
/// numbers of the lattice. The origin is its own parent, because it is solved from the rest state.
struct Transition {
  std::int32_t target = -1;
  std::int32_t parent = -1;
  auto operator<=>(const Transition&) const = default;
};

/// Returns the tag of a converged configuration: expandable if the norm of the tool's force,
/// `force`, is at most workspace.max_force, else terminating. Both in N.
constexpr Tag tagOf(double force, double max_force) {
  return force <= max_force ? Tag::expandable : Tag::terminating;
}

/// Number of failed attempts after which a point is given up. Round 0 (see Frontier) makes at most
/// half of these attempts, rounded up, because its parents all lie on one side of the point and
/// tend to fail together. Later rounds try parents on any side. The limit is lower than the number
/// of neighbours, 26, because a failing transition costs as much as ten converging ones.
inline constexpr int max_attempts_per_point = 8;
/// The same limit for a finger. A point that cannot be reached from three parents usually lies
/// behind a fold. A fourth parent reached only one in twelve of these points, while the fourth and
/// later attempts took a quarter of the time of a build.
inline constexpr int max_attempts_of_finger = 3;

/// Returns the limit that applies to the points of this patch.
constexpr int maxAttempts(const ActivePatch& patch) {
  return patch.finger ? max_attempts_of_finger : max_attempts_per_point;
}

/// Decides which transitions of one uniform lattice are ready, from the lattice and the recorded
/// results of its points alone. Neither time, nor workers, nor the order of arrival has an
/// influence. Tags, parents and attempts are therefore a function of the outcomes of the
/// transitions. A restart that records the known outcomes again continues exactly where the last
/// run stopped.
///
/// - The origin is solved first.
/// - Round 0: the candidates for the parent of a point x are its neighbours with a smaller squared
///   norm, in the order of Lattice::neighbours. A transition from the first expandable candidate
///   becomes ready. If an earlier candidate is not settled yet (neither solved nor unreached), x
///   waits for it. Candidates that are terminating, unreached or already tried are skipped. When no
///   candidate is left, or half of the attempts are used up, x is unreached.
/// - Round r >= 1 begins when every point is settled. The candidates of an unreached point are all
///   neighbours that were expandable when the round began and from which it has not been tried.
///   They are tried one after the other until one succeeds or the attempts are used up.
/// - The frontier is complete when a round has nothing to try. Points that are still unreached have
///   then failed.
///
/// The caller owns the lattice, tags and attempts and passes them to each call. Copyable. One
/// thread at a time.
class Frontier {
 public:
  /// A uniform lattice and the recorded results of its points.
  struct Known {
    const Lattice& lattice;
    const CompactPoints& points;
  };
  /// Starts without any recorded result.
  explicit Frontier(const Known& known, int max_attempts = max_attempts_per_point);

  /// Returns the transitions that became ready since the last call. Each stays open until it is
  /// recorded.
  std::vector<Transition> takeReady() { return std::exchange(ready_, {}); }
  /// Returns true if the transition is ready and not recorded.
  bool isOpen(const Transition& transition) const;
  /// Records the end of an open transition. `known.points` already holds its outcome: the target is
  /// solved or has one more failed attempt. Throws if the transition is not open.
  void record(const Transition& transition, const Known& known);

  /// True when no further transition will become ready. Points still unknown have then failed.
  bool complete() const { return complete_; }
  /// Number of transitions that are ready and not recorded.
  std::int32_t openCount() const { return open_count_; }

 private:
  /// A point is first waiting, then open, then reached or unreached. A later round may open an
  /// unreached point again.
  enum class Phase : std::uint8_t { waiting, open, reached, unreached };
  struct Point {
    Phase phase = Phase::waiting;
    std::int32_t round_reached = 0;
    /// Parent from which an open point is tried, or point that a waiting point waits for.
    std::int32_t blocker = -1;
  };

  void makeReady(std::int32_t target, std::int32_t parent);
  void settle(std::int32_t point);
  void advance(std::int32_t point, const Known& known);
  void releaseWaiting(const Known& known);
  void beginRound(const Known& known);

  std::size_t max_attempts_;
  std::vector<Point> points_;
  std::vector<Transition> ready_;
  /// Points settled in round 0. The points that wait for them have not been advanced yet.
  std::vector<std::int32_t> newly_settled_;
  std::int32_t unsettled_ = 0;
  std::int32_t open_count_ = 0;
  int round_ = 0;
  bool complete_ = false;
};

}  // namespace palpate
