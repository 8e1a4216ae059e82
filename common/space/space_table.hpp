#pragma once

#include <functional>
#include <memory>

#include "common/space/active_patch.hpp"
#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"
#include "common/space/tag.hpp"

namespace palpate {

/// A transition that failed: starting from point `parent`, point `target` could not be solved.
struct FailedAttempt {
  std::int32_t target = -1;  ///< lattice number, as is `parent`
  std::int32_t parent = -1;
  Failure failure;
};

/// The record of one lattice point: a row of a configuration space.
struct PointRecord {
  Tag tag = Tag::unknown;
  /// If the tag is failed: the cause of the attempt that got furthest, or unreachable if there was
  /// no attempt.
  Cause cause = Cause::none;
  /// Lattice number of the point from which this one was solved; -1 if not solved. The origin is
  /// its own parent.
  std::int32_t parent = -1;
  Equilibrium equilibrium;  ///< valid if isSolved(tag)
  double residual = 0;      ///< N
  Cost cost;                ///< `seconds` is not stored
  /// Id of the NodalFields of the whole mesh. Transitions start from these fields. Zero if the
  /// point is not solved. A dataset may store only a part of the fields (Storage).
  ContentId fields;
};

/// Returns whether the force at the point exceeds the scene's max_force. Such a point is
/// terminating, or its solve was abandoned because the force grew far beyond max_force.
inline bool isBeyondForce(const PointRecord& record) {
  return record.tag == Tag::terminating ||
         (record.tag == Tag::failed && record.cause == Cause::beyond_force);
}

/// An exact solution at a position that is not a point of the space. Probes measure the error of
/// interpolation, so no interpolation may use them.
struct Probe {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  /// The parent is a lattice point. The tag is unknown only in an incomplete build.
  PointRecord record;
};

/// Counts of probes by result. All programs use these definitions.
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

/// A configuration space without the nodal fields. points[n] is the record of the lattice point
/// with number n.
struct SpaceTable {
  ActivePatch patch;
  /// N, Workspace::max_force of the scene; the default is the limit of the weakest device.
  double max_force = 3.3;
  /// Whether the body has fibres, which are slack or taut at rest: its stiffness there depends on
  /// the direction of the push, and the stored one is a mean.
  bool has_fibers = false;
  Lattice lattice;
  std::vector<LatticeCell> splits;  ///< cells that were split into eight, sorted by coarserFirst
  std::vector<PointRecord> points;
  /// The failed attempts, sorted by target, then in the order in which they were tried. Attempts
  /// for probes are not included.
  std::vector<FailedAttempt> attempts;
  std::vector<Probe> probes;
  /// The edges that inconsistentEdges() returned for this space when the dataset was sealed
  /// (branch_check.hpp). sealDataset() ignores this member and computes them.
  std::vector<LatticeEdge> inconsistent_edges;
};

/// Read access to a configuration space row by row, without a copy in memory, because a build may
/// have ten million points. Point numbers mean the same as in a SpaceTable.
class SpaceRows {
 public:
  virtual ~SpaceRows() = default;
  virtual const ActivePatch& patch() const = 0;
  /// Returns a lattice that begins with the points() points of the space. Other positions (probes)
  /// may follow.
  virtual const Lattice& lattice() const = 0;
  virtual const std::vector<LatticeCell>& splits() const = 0;
  virtual std::int32_t points() const = 0;  ///< number of points
  virtual PointRecord point(std::int32_t n) const = 0;
  virtual Tag tag(std::int32_t n) const = 0;
  /// Equilibrium without FingerSlopes; null if the point is not solved.
  virtual const ToolEquilibrium* equilibrium(std::int32_t n) const = 0;
  using VisitAttempt = std::function<void(const FailedAttempt&)>;
  virtual void eachAttempt(const VisitAttempt& visit) const = 0;
  virtual std::int32_t probes() const = 0;  ///< number of probes
  virtual Probe probe(std::int32_t n) const = 0;
};
using SpaceRowsList = std::vector<std::unique_ptr<const SpaceRows>>;
/// Returns one SpaceRows per table, which refers to the table. `tables` must outlive the result.
SpaceRowsList rowsOf(const std::vector<SpaceTable>& tables);
/// Copies all rows, without inconsistent edges.
SpaceTable tableOf(const SpaceRows& rows);

/// Interpolation uses a terminating point only if its force is at most this multiple of the largest
/// force of the expandable points, or of the smallest terminating force if only rest is expandable.
/// At larger forces an element beside the tool is being crushed.
/// The force is then tens to thousands of times the range of a device, and a polynomial that
/// interpolates it is wrong in the whole cell.
inline constexpr double largest_force_share = 3;

/// Returns whether any point of the space is solved. In a partial dataset there may be none.
bool hasSolvedPoint(const SpaceTable& space);

/// Returns the largest force of the solved points, N.
double largestForce(const SpaceTable& space);

/// Returns the site whose finger is nearest to `place` (metres). `sites` and the result are indices
/// into `spaces`.
std::size_t nearestSite(const std::vector<SpaceTable>& spaces,
                        const std::vector<std::size_t>& sites, const Eigen::Vector3d& place);

/// Returns for each point, by lattice number, whether interpolation uses it. Interpolation uses all
/// solved points except terminating ones whose force exceeds the limit of largest_force_share. At
/// all other points data are extrapolated from neighbours.
std::vector<bool> interpolatedPoints(const SpaceTable& space);

/// Describes the first inconsistency of a space as a clause for an error message ("probe 3 lies
/// outside of the ball"); empty if there is none. Checks positions and the indices of points, cells
/// and edges.
std::string faultOf(const SpaceTable& space);
std::string faultOf(const SpaceRows& space);

}  // namespace palpate
