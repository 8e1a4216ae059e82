#include "common/space/space_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Returns whether a coordinate of the point lies outside all cells that reach into the ball.
bool isFarOutside(const LatticePoint& point, const Lattice& lattice) {
  const std::int64_t limit =
      static_cast<std::int64_t>(std::floor(lattice.radius() / lattice.spacing() * (1 + 1e-9)) + 1) *
      lattice.divisions();
  return std::ranges::any_of(point, [&](std::int64_t x) { return std::abs(x) > limit; });
}

std::string faultOfSplits(const SpaceRows& space) {
  const std::vector<LatticeCell>& splits = space.splits();
  const std::int32_t divisions = space.lattice().divisions();
  const auto notBefore = [](const LatticeCell& a, const LatticeCell& b) {
    return !coarserFirst(a, b);
  };
  if (std::ranges::adjacent_find(splits, notBefore) != splits.end())
    return "split cells are not sorted by level and lowest corner";
  for (std::size_t i = 0; i < splits.size(); ++i) {
    const LatticeCell& cell = splits[i];
    // The table may come from a file, so check the level before it is used in a shift. A shift by
    // 32 or more is undefined.
    if (cell.level < 0 || cell.level >= 31 || divisions >> (cell.level + 1) == 0)
      return fmt::format("split cell {} has the invalid level {}", i, cell.level);
    const std::int32_t edge = divisions >> cell.level;
    const bool aligned = std::ranges::all_of(
        cell.lowest, [edge](std::int32_t coordinate) { return coordinate % edge == 0; });
    if (!aligned || isFarOutside(cell.lowest, space.lattice()))
      return fmt::format("split cell {} is not a cell of the lattice", i);
    if (cell.level > 0 && !isSplit(splits, parentOf(cell, divisions)))
      return fmt::format("split cell {} lies in a cell that is not split", i);
  }
  return {};
}

class TableRows : public SpaceRows {
 public:
  explicit TableRows(const SpaceTable& table) : table_(table) {}
  const ActivePatch& patch() const override { return table_.patch; }
  const Lattice& lattice() const override { return table_.lattice; }
  const std::vector<LatticeCell>& splits() const override { return table_.splits; }
  std::int32_t points() const override { return static_cast<std::int32_t>(table_.points.size()); }
  PointRecord point(std::int32_t n) const override { return row(n); }
  Tag tag(std::int32_t n) const override { return row(n).tag; }
  const ToolEquilibrium* equilibrium(std::int32_t n) const override {
    return n < points() && isSolved(tag(n)) ? &row(n).equilibrium : nullptr;
  }
  void eachAttempt(const VisitAttempt& visit) const override {
    std::ranges::for_each(table_.attempts, visit);
  }
  std::int32_t probes() const override { return static_cast<std::int32_t>(table_.probes.size()); }
  Probe probe(std::int32_t n) const override { return table_.probes[static_cast<std::size_t>(n)]; }

 private:
  const PointRecord& row(std::int32_t n) const {
    return table_.points[static_cast<std::size_t>(n)];
  }
  const SpaceTable& table_;
};

}  // namespace

SpaceRowsList rowsOf(const std::vector<SpaceTable>& tables) {
  SpaceRowsList rows;
  for (const SpaceTable& table : tables) rows.push_back(std::make_unique<TableRows>(table));
  return rows;
}

SpaceTable tableOf(const SpaceRows& rows) {
  SpaceTable table;
  table.patch = rows.patch();
  table.lattice = rows.lattice().first(rows.points());
  table.splits = rows.splits();
  table.points.reserve(static_cast<std::size_t>(rows.points()));
  for (std::int32_t n = 0; n < rows.points(); ++n) table.points.push_back(rows.point(n));
  rows.eachAttempt([&](const FailedAttempt& attempt) { table.attempts.push_back(attempt); });
  for (std::int32_t n = 0; n < rows.probes(); ++n) table.probes.push_back(rows.probe(n));
  PALPATE_ASSERT(std::ssize(table.points) == table.lattice.size(),
                 "each lattice point must have a record");
  return table;
}

bool hasSolvedPoint(const SpaceTable& space) {
  return std::ranges::any_of(space.points,
                             [](const PointRecord& point) { return isSolved(point.tag); });
}

double largestForce(const SpaceTable& space) {
  double largest = 0;
  for (const PointRecord& point : space.points)
    if (isSolved(point.tag)) largest = std::max(largest, point.equilibrium.force.norm());
  return largest;
}

std::size_t nearestSite(const std::vector<SpaceTable>& spaces,
                        const std::vector<std::size_t>& sites, const Eigen::Vector3d& place) {
  return *std::ranges::min_element(sites, {}, [&](std::size_t site) {
    PALPATE_ASSERT(spaces[site].patch.finger, "a site of an area must be a finger");
    return (spaces[site].patch.finger->center - place).squaredNorm();
  });
}

std::vector<bool> interpolatedPoints(const SpaceTable& space) {
  PALPATE_ASSERT(std::ssize(space.points) == space.lattice.size(),
                 "each lattice point must have a record");
  double largest = 0, weakest_end = std::numeric_limits<double>::infinity();
  for (const PointRecord& point : space.points) {
    const double force = point.equilibrium.force.norm();
    if (point.tag == Tag::expandable) largest = std::max(largest, force);
    if (point.tag == Tag::terminating) weakest_end = std::min(weakest_end, force);
  }
  // In a stiff body only rest may be expandable, and its force is zero.
  const double limit = largest_force_share * (largest > 0 ? largest : weakest_end);
  std::vector<bool> interpolated;
  for (const PointRecord& point : space.points)
    interpolated.push_back(
        point.tag == Tag::expandable ||
        (point.tag == Tag::terminating && point.equilibrium.force.norm() <= limit));
  return interpolated;
}

std::string faultOf(const SpaceRows& space) {
  const Lattice& lattice = space.lattice();
  const std::int32_t size = space.points();
  PALPATE_ASSERT(size <= lattice.size(), "a space cannot have more points than its lattice");
  const auto isPoint = [size](std::int32_t n) { return n >= 0 && n < size; };
  for (std::int32_t n = 0; n < size; ++n) {
    if (isFarOutside(lattice.point(n), lattice))
      return fmt::format("point {} lies far outside of the ball", n);
    if (const std::int32_t parent = space.point(n).parent; parent != -1 && !isPoint(parent))
      return fmt::format("point {} has the invalid parent {}", n, parent);
  }
  for (std::int32_t i = 0; i < space.probes(); ++i) {
    const Probe probe = space.probe(i);
    // The negation makes NaN a fault too.
    if (!(probe.displacement.norm() <= lattice.radius() * (1 + 1e-9)))
      return fmt::format("probe {} lies outside of the ball", i);
    if (const std::int32_t parent = probe.record.parent; parent != -1 && !isPoint(parent))
      return fmt::format("probe {} has the invalid parent {}", i, parent);
  }
  std::string fault;
  space.eachAttempt([&](const FailedAttempt& attempt) {
    if (fault.empty() && (!isPoint(attempt.target) || !isPoint(attempt.parent)))
      fault = fmt::format("a failed attempt has invalid points, {} to {}", attempt.parent,
                          attempt.target);
  });
  return fault.empty() ? faultOfSplits(space) : fault;
}

std::string faultOf(const SpaceTable& space) {
  const auto size = static_cast<std::size_t>(space.lattice.size());
  if (space.points.size() != size)
    return fmt::format("has {} points, but its lattice has {}", space.points.size(), size);
  if (std::string fault = faultOf(TableRows(space)); !fault.empty()) return fault;
  const auto isPoint = [&](std::int32_t n) { return n >= 0 && n < space.lattice.size(); };
  for (const LatticeEdge& edge : space.inconsistent_edges)
    if (!isPoint(edge.a) || !isPoint(edge.b) || edge.a >= edge.b)
      return fmt::format("an inconsistent edge has invalid points, {} and {}", edge.a, edge.b);
  return "";
}

}  // namespace palpate
