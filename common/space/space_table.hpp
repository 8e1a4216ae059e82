#pragma once

#include <functional>
#include <memory>

#include "common/space/active_patch.hpp"
#include "common/space/configuration.hpp"
#include "common/space/lattice.hpp"
#include "common/space/tag.hpp"

namespace palpate {

/// One recorded transition that failed: point `target` could not be reached from `parent`.
struct FailedAttempt {
  std::int32_t target = -1;  ///< lattice numbers
  std::int32_t parent = -1;
  Failure failure;
};

/// What is known of one lattice point; the rows of a configuration space.
struct PointRecord {
  Tag tag = Tag::unknown;
  /// When failed: of the attempt that got furthest, unreachable without one.
  Cause cause = Cause::none;
  /// Lattice number it was solved from; the origin is its own parent; -1 when not solved.
  std::int32_t parent = -1;
  Equilibrium equilibrium;  ///< valid when expandable or terminating
  double residual = 0;      ///< N
  Cost cost;                ///< `seconds` is not stored
  /// Of its NodalFields, all nodes in float32, which transitions from it start with; all zero when
  /// not solved. A dataset may keep less of them (Storage).
  ContentId fields;
};

/// The force there is more than the scene's largest: it was solved so, or given up far beyond it.
inline bool isBeyondForce(const PointRecord& record) {
  return record.tag == Tag::terminating ||
         (record.tag == Tag::failed && record.cause == Cause::beyond_force);
}

/// An exact solution at a position off the lattice. No interpolation may use it: it is there to
/// measure interpolations.
struct Probe {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< metres
  PointRecord record;  ///< its parent is a lattice point; never unknown in a complete build
};

/// What became of probes, as every program counts them.
struct ProbeCounts {
  std::size_t all = 0;
  std::size_t within_force = 0;  ///< solved within the scene's largest force: measured with
  std::size_t beyond_force = 0;  ///< isBeyondForce()

  void add(const PointRecord& probe) {
    ++all;
    within_force += probe.tag == Tag::expandable;
    beyond_force += isBeyondForce(probe);
  }
  std::size_t unsolved() const { return all - within_force - beyond_force; }
};

/// One configuration space without the bulky fields. points[n] belongs to lattice number n.
struct SpaceTable {
  ActivePatch patch;
  double max_force = 3.3;  ///< N, of the scene's workspace; default: of the smallest device
  Lattice lattice;
  std::vector<LatticeCell> splits;  ///< cells that were split into eight, by coarserFirst
  std::vector<PointRecord> points;
  /// Sorted by (target, order in which they were tried); no probes.
  std::vector<FailedAttempt> attempts;
  std::vector<Probe> probes;
  /// inconsistentEdges of this space (branch_check.hpp), as they were when the dataset was sealed;
  /// sealDataset finds them itself.
  std::vector<LatticeEdge> inconsistent_edges;
};

/// One configuration space, row by row: what is gone through without being copied, since a build
/// may have ten million points. Its numbers mean what those of a SpaceTable do.
class SpaceRows {
 public:
  virtual ~SpaceRows() = default;
  virtual const ActivePatch& patch() const = 0;
  /// Its first points are the space's; others (probes) may follow.
  virtual const Lattice& lattice() const = 0;
  virtual const std::vector<LatticeCell>& splits() const = 0;
  virtual std::int32_t points() const = 0;  ///< how many
  virtual PointRecord point(std::int32_t n) const = 0;
  virtual Tag tag(std::int32_t n) const = 0;
  /// Without what only a finger has; null when the point is not solved.
  virtual const ToolEquilibrium* equilibrium(std::int32_t n) const = 0;
  virtual std::size_t attempts() const = 0;  ///< how many
  using VisitAttempt = std::function<void(const FailedAttempt&)>;
  virtual void eachAttempt(const VisitAttempt& visit) const = 0;
  virtual std::int32_t probes() const = 0;  ///< how many
  virtual Probe probe(std::int32_t n) const = 0;
};
using SpaceRowsList = std::vector<std::unique_ptr<const SpaceRows>>;
/// Those of tables, which must outlive them.
SpaceRowsList rowsOf(const std::vector<SpaceTable>& tables);
/// A copy of all of it, without inconsistent edges.
SpaceTable tableOf(const SpaceRows& rows);

/// Largest force of a terminating point that cells are interpolated with, in largest forces of the
/// expandable points. Beyond it an element beside the tool is being crushed: the force is tens to
/// thousands of times what a device renders, and a polynomial that meets it is wrong in the whole
/// cell.
inline constexpr double largest_force_share = 3;

/// By lattice number, whether cells are interpolated with the point: it is solved and, if it is
/// terminating, within largest_force_share. The others are continued from their neighbours, as if
/// they had failed.
std::vector<bool> interpolatedPoints(const SpaceTable& space);

/// What of `space` contradicts itself, as a clause for errors ("probe 3 lies outside of the
/// workspace"); empty when nothing does. Looked at are numbers that name points, cells and edges,
/// and positions.
std::string faultOf(const SpaceTable& space);
std::string faultOf(const SpaceRows& space);

}  // namespace palpate
