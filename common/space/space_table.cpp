#include "common/space/space_table.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Coordinates beyond those of the cubes that reach into the ball.
bool isFarOutside(const LatticePoint& point, const Lattice& lattice) {
  const std::int64_t limit =
      static_cast<std::int64_t>(std::floor(lattice.radius() / lattice.spacing() * (1 + 1e-9)) + 1) *
      lattice.divisions();
  return std::ranges::any_of(point, [&](std::int64_t x) { return std::abs(x) > limit; });
}

std::string faultOfSplits(const SpaceTable& space) {
  const std::int32_t divisions = space.lattice.divisions();
  const auto notBefore = [](const LatticeCell& a, const LatticeCell& b) {
    return !coarserFirst(a, b);
  };
  if (std::ranges::adjacent_find(space.splits, notBefore) != space.splits.end())
    return "splits are not sorted by level and lowest";
  for (std::size_t i = 0; i < space.splits.size(); ++i) {
    const LatticeCell& cell = space.splits[i];
    // A shift by 31 or more is undefined, and the table may come from a file.
    if (cell.level < 0 || cell.level >= 31 || divisions >> (cell.level + 1) == 0)
      return fmt::format("split {} is of level {}, which has no halves", i, cell.level);
    const std::int32_t edge = divisions >> cell.level;
    const bool aligned = std::ranges::all_of(
        cell.lowest, [edge](std::int32_t coordinate) { return coordinate % edge == 0; });
    if (!aligned || isFarOutside(cell.lowest, space.lattice))
      return fmt::format("split {} is no cell of the lattice", i);
    if (cell.level > 0 && !isSplit(space.splits, parentOf(cell, divisions)))
      return fmt::format("split {} lies in a cell that is not split", i);
  }
  return {};
}

}  // namespace

std::vector<bool> interpolatedPoints(const SpaceTable& space) {
  PALPATE_ASSERT(std::ssize(space.points) == space.lattice.size(),
                 "points[n] belongs to lattice number n");
  double largest = 0;
  for (const PointRecord& point : space.points)
    if (point.tag == Tag::expandable) largest = std::max(largest, point.equilibrium.force.norm());
  const double limit =
      // Without an expandable point there is no measure of what is too much.
      largest > 0 ? largest_force_share * largest : std::numeric_limits<double>::infinity();
  std::vector<bool> interpolated;
  for (const PointRecord& point : space.points)
    interpolated.push_back(
        point.tag == Tag::expandable ||
        (point.tag == Tag::terminating && point.equilibrium.force.norm() <= limit));
  return interpolated;
}

std::string faultOf(const SpaceTable& space) {
  const Lattice& lattice = space.lattice;
  if (space.points.size() != static_cast<std::size_t>(lattice.size()))
    return fmt::format("has {} points, the lattice {}", space.points.size(), lattice.size());
  const auto isPoint = [&](std::int32_t n) { return n >= 0 && n < lattice.size(); };
  for (std::int32_t n = 0; n < lattice.size(); ++n) {
    if (isFarOutside(lattice.point(n), lattice))
      return fmt::format("point {} lies far outside of the ball", n);
    if (const std::int32_t parent = space.points[n].parent; parent != -1 && !isPoint(parent))
      return fmt::format("point {} has parent {}", n, parent);
  }
  for (std::size_t i = 0; i < space.probes.size(); ++i) {
    // Negated, so that NaN is a fault.
    if (!(space.probes[i].displacement.norm() <= lattice.radius() * (1 + 1e-9)))
      return fmt::format("probe {} lies outside of the ball", i);
    if (const std::int32_t parent = space.probes[i].record.parent; parent != -1 && !isPoint(parent))
      return fmt::format("probe {} has parent {}", i, parent);
  }
  for (const FailedAttempt& attempt : space.attempts)
    if (!isPoint(attempt.target) || !isPoint(attempt.parent))
      return fmt::format("an attempt went from point {} to point {}", attempt.parent,
                         attempt.target);
  for (const LatticeEdge& edge : space.inconsistent_edges)
    if (!isPoint(edge.a) || !isPoint(edge.b) || edge.a >= edge.b)
      return fmt::format("an inconsistent edge joins points {} and {}", edge.a, edge.b);
  return faultOfSplits(space);
}

}  // namespace palpate
