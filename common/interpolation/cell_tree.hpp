#pragma once

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/space/lattice.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Where the nodal data of a corner come from.
enum class SlotKind : std::uint8_t {
  /// A lattice point that holds an equilibrium (and is one of interpolatedPoints).
  solved,
  /// Nothing is solved there (outside of the ball, failed, crushed): extrapolated from solved
  /// points.
  ghost,
  /// On the boundary of a coarser leaf and no corner of it: what that leaf interpolates there,
  /// whether or not the position is solved, so that interpolants agree on the common boundary.
  hanging,
};

/// A position at which leaves meet. Data that belong to slots, not to leaves, make interpolants
/// continuous.
struct CellSlot {
  LatticePoint point = {0, 0, 0};
  SlotKind kind = SlotKind::ghost;
  std::int32_t number = -1;                         ///< lattice number when solved
  std::int32_t leaf = -1;                           ///< the coarser leaf when hanging
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< 0..1 in that leaf, when hanging
};

/// Slots of the eight corners of a leaf. Corner c has offset (c & 1, c >> 1 & 1, c >> 2 & 1).
using LeafCorners = std::array<std::int32_t, 8>;

/// Where a displacement lies.
struct LeafPlace {
  std::int32_t leaf = -1;                           ///< -1: not in the ball
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< 0..1 in the leaf
};

/// Whether a place in a leaf is a corner of it.
inline bool isCorner(const Eigen::Vector3d& local) noexcept {
  return (local.array() == 0 || local.array() == 1).all();
}

/// The leaf cells of one configuration space: all cells between uniform lattice positions that
/// reach into the workspace ball, those that refinement split replaced by their eighths that do,
/// and so on. Together they contain the whole ball. A method that interpolates from nodal data
///   1. takes those of the solved slots from the space,
///   2. fills those of the ghosts (viewer/fields/cell_data.hpp),
///   3. fills those of the hanging slots in the order of hangingSlots(), each by evaluating itself
///   in
///      the slot's coarser leaf, whose corners are complete by then (fillHanging),
/// and is then as continuous over the whole ball as it is between two cells of the uniform lattice,
/// if its restriction to a face depends on the data of the face's corners alone and is reproduced
/// from what it says at four points of the face (true of tensor products of Hermite polynomials).
/// Immutable after construction: any thread may read.
class CellTree {
 public:
  /// Copies what it needs. Error when no point of the space is solved.
  explicit CellTree(const SpaceTable& space);

  /// Ordered by place in the cube of root cells, children of a split cell together. Never empty.
  const std::vector<LatticeCell>& leaves() const { return leaves_; }
  /// Of a leaf, by its place in leaves().
  const LeafCorners& corners(std::int32_t leaf) const { return corners_[at(leaf)]; }
  /// Length of a leaf's edges, metres.
  double edge(std::int32_t leaf) const { return edge_[at(leaf)]; }
  /// Sorted by coordinates.
  const std::vector<CellSlot>& slots() const { return slots_; }
  /// Displacement of a slot, metres.
  Eigen::Vector3d displacement(std::int32_t slot) const;
  /// The hanging ones, coarse to fine: each after all hanging corners of its coarser leaf.
  const std::vector<std::int32_t>& hangingSlots() const { return hanging_; }
  double radius() const { return radius_; }              ///< of the ball, metres
  double spacing() const { return spacing_; }            ///< edge of the root cells, metres
  double unit() const { return spacing_ / divisions_; }  ///< metres per lattice coordinate
  /// Whether all corners of a leaf are ghosts, or hang in leaves of which that is true.
  bool unsupported(std::int32_t leaf) const { return unsupported_[at(leaf)]; }

  /// The leaf at a lattice position in the octant (negative or positive per axis) that bit `axis`
  /// of `octant` says; leaf -1 where there is none.
  LeafPlace leafBeside(const LatticePoint& point, std::size_t octant) const noexcept;
  /// The leaf around a displacement of the closed ball (1e-9 of the radius outside of it counts as
  /// on it), in a time that depends on the number of levels only. Leaf -1 for all others, NaN among
  /// them. Real time: does not allocate, lock, throw or log.
  LeafPlace find(const Eigen::Vector3d& displacement) const noexcept;

 private:
  void addCell(const SpaceTable& space, const LatticeCell& cell, std::size_t place);
  void makeSlots(const SpaceTable& space);
  void hang(CellSlot& slot) const;
  void markUnsupported();
  LeafPlace descend(const Eigen::Vector3d& in_spacings) const noexcept;

  double radius_;
  double spacing_;
  std::int32_t divisions_;
  std::int32_t extent_;  ///< root cells on each side of the origin, per axis
  /// The cube of root cells, x slowest, then eighths, eight together: the number of a leaf, no_cell
  /// where nothing reaches into the ball, or ~ the place of the first eighth.
  std::vector<std::int32_t> nodes_;
  std::vector<LatticeCell> leaves_;
  std::vector<double> edge_;
  std::vector<LeafCorners> corners_;
  std::vector<CellSlot> slots_;
  std::vector<std::int32_t> hanging_;
  std::vector<bool> unsupported_;
};

/// The nearest displacement in the closed ball: itself, or the point of the sphere in its
/// direction; the origin for NaN. Finite for any input. Real time.
Eigen::Vector3d nearestInBall(const Eigen::Vector3d& displacement, double radius) noexcept;

/// Tri-linear weights of the eight corners at a place in a leaf. Real time.
inline std::array<double, 8> trilinearWeights(const Eigen::Vector3d& local) noexcept {
  std::array<double, 8> weights;
  for (std::size_t c = 0; c < 8; ++c)
    weights[c] = ((c & 1) != 0 ? local.x() : 1 - local.x()) *
                 ((c & 2) != 0 ? local.y() : 1 - local.y()) *
                 ((c & 4) != 0 ? local.z() : 1 - local.z());
  return weights;
}

/// Sets the values of all hanging slots: values[slot] = evaluate(leaf, local), coarse to fine.
/// `evaluate` reads `values` at the corners of the leaf.
template <class Values, class Evaluate>
void fillHanging(const CellTree& tree, Values& values, Evaluate evaluate) {
  PALPATE_ASSERT(values.size() == tree.slots().size(), "there is one value per slot");
  for (const std::int32_t s : tree.hangingSlots()) {
    const CellSlot& slot = tree.slots()[at(s)];
    values[at(s)] = evaluate(slot.leaf, slot.local);
  }
}

}  // namespace palpate
