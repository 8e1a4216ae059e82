#pragma once

#include <functional>
#include <memory>

#include "common/space/active_patch.hpp"
#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"
#include "common/space/tag.hpp"

namespace palpate {

/// A recorded transition that failed: point `target` could not be reached from `parent`.
struct FailedAttempt {
  std::int32_t target = -1;  ///< lattice numbers
  std::int32_t parent = -1;
  Failure failure;
};

/// The record of one lattice point: a row of a configuration space.
struct PointRecord {
  Tag tag = Tag::unknown;
  /// Cause of the attempt that got furthest if the tag is failed; unreachable if there was no
  /// attempt.
  Cause cause = Cause::none;
  /// Lattice number of the point it was solved from, -1 if not solved. The origin is its own
  /// parent.
  std::int32_t parent = -1;
  Equilibrium equilibrium;  ///< valid when expandable or terminating
  double residual = 0;      ///< N
  Cost cost;                ///< `seconds` is not stored
  /// Id of its NodalFields (all nodes, float32), from which transitions start; zero if not solved.
  /// A dataset may store fewer fields (Storage).
  ContentId fields;
};

/// Returns whether the force exceeds the scene's largest: the point was solved there, or given up
/// far beyond it.
inline bool isBeyondForce(const PointRecord& record) {
  return record.tag == Tag::terminating ||
         (record.tag == Tag::failed && record.cause == Cause::beyond_force);
}

/// An exact solution at a position off the lattice. Probes measure interpolations, so no
/// interpolation may use one.
struct Probe {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  PointRecord record;  ///< its parent is a lattice point; unknown only in an incomplete build
};

/// Results of probes, as every program counts them.
struct ProbeCounts {
  std::size_t all = 0;
  std::size_t within_force = 0;  ///< solved within max_force; error statistics use these
  std::size_t beyond_force = 0;  ///< isBeyondForce()

  void add(const PointRecord& probe) {
    ++all;
    within_force += probe.tag == Tag::expandable;
    beyond_force += isBeyondForce(probe);
  }
  std::size_t unsolved() const { return all - within_force - beyond_force; }
};

/// A configuration space without the nodal fields. points[n] belongs to lattice number n.
struct SpaceTable {
  ActivePatch patch;
  double max_force = 3.3;  ///< N, the scene's limit; the default suits the smallest device
  Lattice lattice;
  std::vector<LatticeCell> splits;  ///< cells that were split into eight, sorted by coarserFirst
  std::vector<PointRecord> points;
  /// Sorted by (target, order of trial); without attempts of probes.
  std::vector<FailedAttempt> attempts;
  std::vector<Probe> probes;
  /// inconsistentEdges of this space (branch_check.hpp) when the dataset was sealed. sealDataset
  /// computes them itself.
  std::vector<LatticeEdge> inconsistent_edges;
};

/// A configuration space row by row, for reading without a copy, since a build may have ten million
/// points. Numbers mean the same as in a SpaceTable.
class SpaceRows {
 public:
  virtual ~SpaceRows() = default;
  virtual const ActivePatch& patch() const = 0;
  /// Its first points belong to the space; other positions (probes) may follow.
  virtual const Lattice& lattice() const = 0;
  virtual const std::vector<LatticeCell>& splits() const = 0;
  virtual std::int32_t points() const = 0;  ///< number of points
  virtual PointRecord point(std::int32_t n) const = 0;
  virtual Tag tag(std::int32_t n) const = 0;
  /// Equilibrium without the derivatives of a finger, null if the point is not solved.
  virtual const ToolEquilibrium* equilibrium(std::int32_t n) const = 0;
  virtual std::size_t attempts() const = 0;  ///< number of failed attempts
  using VisitAttempt = std::function<void(const FailedAttempt&)>;
  virtual void eachAttempt(const VisitAttempt& visit) const = 0;
  virtual std::int32_t probes() const = 0;  ///< number of probes
  virtual Probe probe(std::int32_t n) const = 0;
};
using SpaceRowsList = std::vector<std::unique_ptr<const SpaceRows>>;
/// Returns the rows of `tables`, which must outlive them.
SpaceRowsList rowsOf(const std::vector<SpaceTable>& tables);
/// Copies all rows, without inconsistent edges.
SpaceTable tableOf(const SpaceRows& rows);

/// Largest force of a terminating point that interpolation uses, as a multiple of the largest force
/// of the expandable points. Beyond it an element beside the tool is being crushed. The force is
/// then tens to thousands of times the range of a device, and a polynomial through it is wrong in
/// the whole cell.
inline constexpr double largest_force_share = 3;

/// Returns, by lattice number, whether interpolation uses the point: it is solved and, if
/// terminating, within largest_force_share. The others are extrapolated from their neighbours like
/// failed points.
std::vector<bool> interpolatedPoints(const SpaceTable& space);

/// Describes the first inconsistency as a clause for an error message ("probe 3 lies outside of the
/// workspace"); empty if there is none. Checks positions and the indices of points, cells and
/// edges.
std::string faultOf(const SpaceTable& space);
std::string faultOf(const SpaceRows& space);

}  // namespace palpate
