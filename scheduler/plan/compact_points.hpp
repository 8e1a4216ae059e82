#pragma once

#include <array>
#include <deque>
#include <unordered_map>
#include <utility>
#include <vector>

#include "common/space/space_table.hpp"

namespace palpate {

/// Counts of points, and of failed attempts at them.
struct PointCounts {
  std::array<std::int32_t, tag_words.size()> of_tag = {};
  std::int64_t attempts = 0;        ///< number of failed attempts
  std::int32_t unknown_tried = 0;   ///< number of unknown points with a failed attempt
  std::int32_t unsolved_tried = 0;  ///< number of unknown or failed points with a failed attempt

  std::int32_t of(Tag tag) const { return of_tag[static_cast<std::size_t>(tag)]; }
  std::int32_t solved() const { return of(Tag::expandable) + of(Tag::terminating); }
};
/// Counts indexed by Cause.
using CountsOfCauses = std::array<std::int64_t, 1 + static_cast<std::size_t>(Cause::bifurcation)>;

/// The points of one configuration space, stored compactly, with counts by tag and by cause.
///
/// A build may have ten million points. A point takes about 180 bytes, and 600 more if the tool is
/// a finger. A PointRecord always takes about 800 bytes, most of them for data that only fingers
/// have. Reading a count takes constant time.
class CompactPoints {
 public:
  /// Starts with the `uniform` points of the uniform lattice, all unknown. Points added later are
  /// counted separately (added()).
  explicit CompactPoints(std::int32_t uniform);

  void add();  ///< adds an unknown point
  std::int32_t size() const { return size_; }
  Tag tag(std::int32_t n) const { return at(n).tag; }
  Cause cause(std::int32_t n) const { return at(n).cause; }
  std::int32_t parent(std::int32_t n) const { return at(n).parent; }
  std::int32_t factorizations(std::int32_t n) const { return at(n).factorizations; }
  const ContentId& fields(std::int32_t n) const { return at(n).fields; }
  /// Returns the equilibrium without the slopes that only a finger has.
  const ToolEquilibrium& equilibrium(std::int32_t n) const { return at(n).equilibrium; }
  /// Returns the complete record except Cost::seconds.
  PointRecord record(std::int32_t n) const;
  /// Returns the failed attempts in the order in which they were made.
  const std::vector<FailedAttempt>& attempts(std::int32_t n) const;

  void solve(std::int32_t n, const PointRecord& found);
  void fail(std::int32_t n, Cause cause);
  void addAttempt(const FailedAttempt& attempt);

  const PointCounts& uniform() const { return uniform_; }
  const PointCounts& added() const { return added_; }
  const CountsOfCauses& failedPoints() const { return failed_points_; }
  const CountsOfCauses& failedAttempts() const { return failed_attempts_; }

 private:
  struct Point {
    ToolEquilibrium equilibrium;
    double residual = 0;
    ContentId fields;
    std::int32_t newton_iterations = 0, factorizations = 0, steps = 0;
    std::int32_t parent = -1;
    std::int32_t slopes = -1;  ///< index in slopes_; -1: all slopes are zero
    Tag tag = Tag::unknown;
    Cause cause = Cause::none;
    bool tried = false;  ///< at least one attempt failed
  };
  /// Points per page. With pages, adding a point does not move ten million others.
  static constexpr std::int32_t page = 4096;

  const Point& at(std::int32_t n) const {
    return pages_[static_cast<std::size_t>(n / page)][static_cast<std::size_t>(n % page)];
  }
  Point& at(std::int32_t n) { return const_cast<Point&>(std::as_const(*this).at(n)); }
  PointCounts& countsOf(std::int32_t n) { return n < uniform_size_ ? uniform_ : added_; }
  void count(std::int32_t n, int by);

  std::int32_t size_ = 0;
  std::int32_t uniform_size_;
  std::vector<std::vector<Point>> pages_;
  std::deque<FingerSlopes> slopes_;
  std::unordered_map<std::int32_t, std::vector<FailedAttempt>> attempts_;
  PointCounts uniform_, added_;
  CountsOfCauses failed_points_ = {}, failed_attempts_ = {};
};

}  // namespace palpate
