#include "scheduler/plan/frontier.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {

Frontier::Frontier(Lattice lattice, double max_force, int max_attempts)
    : lattice_(std::move(lattice)),
      max_force_(max_force),
      max_attempts_(max_attempts),
      points_(lattice_.size()),
      unsettled_(lattice_.size()) {
  // Points near the origin wait for the origin, farther ones for those; so nothing but the origin
  // is ready.
  for (std::int32_t n = 1; n < lattice_.size(); ++n) advance(n);
  makeReady(0, 0);
}

bool Frontier::isOpen(const Transition& transition) const {
  if (transition.target < 0 || transition.target >= lattice_.size()) return false;
  const Point& point = points_[transition.target];
  return point.phase == Phase::open && point.blocker == transition.parent;
}

void Frontier::record(const Transition& transition, std::optional<double> force) {
  if (!isOpen(transition))
    throw failure("transition to point {} from point {} is recorded but was not asked for",
                  transition.target, transition.parent);
  Point& point = points_[transition.target];
  PALPATE_ASSERT(open_count_ > 0, "an open transition is counted");
  --open_count_;
  if (force) {
    point.phase = Phase::reached;
    point.tag = tagOf(*force, max_force_);
    point.round_reached = round_;
    settle(transition.target);
  } else {
    failed_parents_[transition.target].push_back(transition.parent);
    advance(transition.target);
  }
  releaseWaiting();
  if (unsettled_ == 0) beginRound();
}

Tag Frontier::tag(std::int32_t point) const {
  const Point& p = points_[point];
  return complete_ && p.phase == Phase::unreached ? Tag::failed : p.tag;
}

void Frontier::makeReady(std::int32_t target, std::int32_t parent) {
  points_[target].phase = Phase::open;
  points_[target].blocker = parent;
  ready_.push_back({target, parent});
  ++open_count_;
}

void Frontier::settle(std::int32_t point) {
  PALPATE_ASSERT(unsettled_ > 0, "a point is settled once in a round");
  --unsettled_;
  // Later rounds look only at what was expandable when they began, so that nobody waits in them.
  if (round_ == 0) newly_settled_.push_back(point);
}

void Frontier::advance(std::int32_t point) {
  Point& p = points_[point];
  // Half is kept for other sides: in round 0 all parents lie on one, and tend to fail together.
  const std::size_t budget = round_ == 0 ? (max_attempts_ + 1) / 2 : max_attempts_;
  const std::int64_t norm = squaredNorm(lattice_.point(point));
  static const std::vector<std::int32_t> none;
  const auto failures = failed_parents_.find(point);
  const std::vector<std::int32_t>& failed =
      failures == failed_parents_.end() ? none : failures->second;
  const bool found = failed.size() < budget && lattice_.visitNeighbours(point, [&](auto candidate) {
    const Point& c = points_[candidate];
    if (round_ == 0) {
      // Strictly nearer to the origin: two points never wait for each other.
      if (squaredNorm(lattice_.point(candidate)) >= norm) return false;
      if (c.phase == Phase::waiting || c.phase == Phase::open) {
        p.phase = Phase::waiting;
        p.blocker = candidate;
        return true;
      }
    } else if (c.round_reached == round_) {
      return false;  // does not count yet: which comes first would depend on timing
    }
    const bool tried = std::ranges::find(failed, candidate) != failed.end();
    if (c.tag != Tag::expandable || tried) return false;
    makeReady(point, candidate);
    return true;
  });
  if (found) return;
  p.phase = Phase::unreached;
  settle(point);
}

/// With a stack and not by recursion: a chain of waiting points may cross the whole lattice.
void Frontier::releaseWaiting() {
  while (!newly_settled_.empty()) {
    const std::int32_t settled = newly_settled_.back();
    newly_settled_.pop_back();
    lattice_.visitNeighbours(settled, [&](std::int32_t neighbour) {
      const Point& n = points_[neighbour];
      if (n.phase == Phase::waiting && n.blocker == settled) advance(neighbour);
      return false;
    });
  }
}

void Frontier::beginRound() {
  ++round_;
  for (std::int32_t n = 0; n < lattice_.size(); ++n) {
    // Those that were given up get another chance, from what was reached meanwhile.
    if (points_[n].phase != Phase::unreached) continue;
    ++unsettled_;
    advance(n);
  }
  complete_ = open_count_ == 0;
}

}  // namespace palpate
