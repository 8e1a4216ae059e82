#include "scheduler/plan/frontier.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {

Frontier::Frontier(const Known& known, int max_attempts)
    : max_attempts_(max_attempts), points_(known.lattice.size()), unsettled_(known.lattice.size()) {
  // Points near the origin wait for the origin, and farther points wait for nearer ones. Only the
  // origin is ready.
  for (std::int32_t n = 1; n < known.lattice.size(); ++n) advance(n, known);
  makeReady(0, 0);
}

bool Frontier::isOpen(const Transition& transition) const {
  if (transition.target < 0 || transition.target >= std::ssize(points_)) return false;
  const Point& point = points_[transition.target];
  return point.phase == Phase::open && point.blocker == transition.parent;
}

void Frontier::record(const Transition& transition, const Known& known) {
  if (!isOpen(transition))
    throw failure("transition to point {} from point {} is recorded but was not requested",
                  transition.target, transition.parent);
  Point& point = points_[transition.target];
  PALPATE_ASSERT(open_count_ > 0, "every open transition must be counted");
  --open_count_;
  if (isSolved(known.points.tag(transition.target))) {
    point.phase = Phase::reached;
    point.round_reached = round_;
    settle(transition.target);
  } else {
    PALPATE_ASSERT(!known.points.attempts(transition.target).empty() &&
                       known.points.attempts(transition.target).back().parent == transition.parent,
                   "a failure must be recorded before the next attempt");
    advance(transition.target, known);
  }
  releaseWaiting(known);
  if (unsettled_ == 0) beginRound(known);
}

void Frontier::makeReady(std::int32_t target, std::int32_t parent) {
  points_[target].phase = Phase::open;
  points_[target].blocker = parent;
  ready_.push_back({target, parent});
  ++open_count_;
}

void Frontier::settle(std::int32_t point) {
  PALPATE_ASSERT(unsettled_ > 0, "a point must be decided only once per round");
  --unsettled_;
  // Later rounds use only points that were expandable when the round began, so no point waits.
  if (round_ == 0) newly_settled_.push_back(point);
}

void Frontier::advance(std::int32_t point, const Known& known) {
  Point& p = points_[point];
  // The parents of round 0 lie on one side and tend to fail together. Save half of the attempts for
  // parents on other sides.
  const std::size_t budget = round_ == 0 ? (max_attempts_ + 1) / 2 : max_attempts_;
  const std::int64_t norm = squaredNorm(known.lattice.point(point));
  const std::vector<FailedAttempt>& failed = known.points.attempts(point);
  Neighbours candidates;
  if (failed.size() < budget) candidates = known.lattice.neighbours(point);
  for (const std::int32_t candidate : candidates) {
    const Point& c = points_[candidate];
    if (round_ == 0) {
      // Use only parents strictly nearer to the origin, so that two points never wait for each
      // other.
      if (squaredNorm(known.lattice.point(candidate)) >= norm) continue;
      if (c.phase == Phase::waiting || c.phase == Phase::open) {
        p.phase = Phase::waiting;
        p.blocker = candidate;
        return;
      }
    } else if (c.round_reached == round_) {
      continue;  // reached in this round: the order of arrival would matter
    }
    const bool tried = std::ranges::find(failed, candidate, &FailedAttempt::parent) != failed.end();
    if (known.points.tag(candidate) != Tag::expandable || tried) continue;
    makeReady(point, candidate);
    return;
  }
  p.phase = Phase::unreached;
  settle(point);
}

/// Uses a stack instead of recursion: a chain of waiting points may cross the whole lattice.
void Frontier::releaseWaiting(const Known& known) {
  while (!newly_settled_.empty()) {
    const std::int32_t settled = newly_settled_.back();
    newly_settled_.pop_back();
    for (const std::int32_t neighbour : known.lattice.neighbours(settled)) {
      const Point& n = points_[neighbour];
      if (n.phase == Phase::waiting && n.blocker == settled) advance(neighbour, known);
    }
  }
}

void Frontier::beginRound(const Known& known) {
  ++round_;
  for (std::int32_t n = 0; n < std::ssize(points_); ++n) {
    // Try each unreached point again, from points that were reached in the meantime.
    if (points_[n].phase != Phase::unreached) continue;
    ++unsettled_;
    advance(n, known);
  }
  complete_ = open_count_ == 0;
  if (complete_) points_ = {};  // frees memory: a lattice may have ten million points
}

}  // namespace palpate
