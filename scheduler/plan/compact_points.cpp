#include "scheduler/plan/compact_points.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

CompactPoints::CompactPoints(std::int32_t uniform) : uniform_size_(uniform) {
  while (size_ < uniform) add();
}

void CompactPoints::add() {
  if (size_ % page == 0) {
    pages_.emplace_back();
    if (size_ + page <= uniform_size_) pages_.back().reserve(page);
  }
  pages_.back().emplace_back();
  ++size_;
  count(size_ - 1, 1);
}

/// Adds `by` to every count that includes point n, except the counts of attempts.
void CompactPoints::count(std::int32_t n, int by) {
  const Point& point = at(n);
  PointCounts& counts = countsOf(n);
  counts.of_tag[static_cast<std::size_t>(point.tag)] += by;
  if (point.tried && !isSolved(point.tag)) counts.unsolved_tried += by;
  if (point.tried && point.tag == Tag::unknown) counts.unknown_tried += by;
  if (point.tag == Tag::failed) failed_points_[static_cast<std::size_t>(point.cause)] += by;
}

PointRecord CompactPoints::record(std::int32_t n) const {
  const Point& point = at(n);
  PointRecord record;
  record.tag = point.tag;
  record.cause = point.cause;
  record.parent = point.parent;
  static_cast<ToolEquilibrium&>(record.equilibrium) = point.equilibrium;
  if (point.slopes >= 0)
    static_cast<FingerSlopes&>(record.equilibrium) =
        slopes_[static_cast<std::size_t>(point.slopes)];
  record.residual = point.residual;
  record.cost = {point.newton_iterations, point.factorizations, point.steps, 0};
  record.fields = point.fields;
  return record;
}

const std::vector<FailedAttempt>& CompactPoints::attempts(std::int32_t n) const {
  static const std::vector<FailedAttempt> none;
  if (!at(n).tried) return none;
  return attempts_.at(n);
}

void CompactPoints::solve(std::int32_t n, const PointRecord& found) {
  PALPATE_ASSERT(isSolved(found.tag), "only solved points can have an equilibrium");
  PALPATE_ASSERT(n >= 0 && n < size_, "an equilibrium must belong to a point of the plan");
  count(n, -1);
  Point& point = at(n);
  point.tag = found.tag;
  point.cause = found.cause;
  point.parent = found.parent;
  point.equilibrium = found.equilibrium;
  point.residual = found.residual;
  point.newton_iterations = found.cost.newton_iterations;
  point.factorizations = found.cost.factorizations;
  point.steps = found.cost.steps;
  point.fields = found.fields;
  if (point.slopes < 0 && hasDrive(found.equilibrium)) {
    point.slopes = static_cast<std::int32_t>(slopes_.size());
    slopes_.emplace_back();
  }
  if (point.slopes >= 0) slopes_[static_cast<std::size_t>(point.slopes)] = found.equilibrium;
  count(n, 1);
}

void CompactPoints::fail(std::int32_t n, Cause cause) {
  count(n, -1);
  at(n).tag = Tag::failed;
  at(n).cause = cause;
  count(n, 1);
}

void CompactPoints::addAttempt(const FailedAttempt& attempt) {
  const std::int32_t n = attempt.target;
  PALPATE_ASSERT(n >= 0 && n < size_, "an attempt must belong to a point of the plan");
  count(n, -1);
  at(n).tried = true;
  count(n, 1);
  attempts_[n].push_back(attempt);
  ++countsOf(n).attempts;
  ++failed_attempts_[static_cast<std::size_t>(attempt.failure.cause)];
}

}  // namespace palpate
