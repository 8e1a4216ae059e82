#pragma once

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/space/lattice.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Source of the nodal data of a corner.
enum class SlotKind : std::uint8_t {
  /// A lattice point that holds an equilibrium (and is one of interpolatedPoints).
  solved,
  /// Not solved (outside the ball, failed, crushed); extrapolated from solved points.
  ghost,
  /// On the boundary of a coarser leaf, but not one of its corners. It takes the interpolant of
  /// that leaf, even if the position is solved, so that interpolants agree on the common boundary.
  hanging,
};

/// A position at which leaves meet. Data belong to slots rather than leaves, which makes
/// interpolants continuous.
struct CellSlot {
  LatticePoint point = {0, 0, 0};
  SlotKind kind = SlotKind::ghost;
  std::int32_t number = -1;                         ///< lattice number if solved
  std::int32_t leaf = -1;                           ///< the coarser leaf if hanging
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< 0..1 in that leaf, if hanging
};

/// Slots of the eight corners of a leaf. Corner c has offset (c & 1, c >> 1 & 1, c >> 2 & 1).
using LeafCorners = std::array<std::int32_t, 8>;

/// The leaf that contains a displacement, and the place in it.
struct LeafPlace {
  std::int32_t leaf = -1;                           ///< -1 if outside the ball
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< 0..1 in the leaf
};

/// Returns whether a place in a leaf is one of its corners.
inline bool isCorner(const Eigen::Vector3d& local) noexcept {
  return (local.array() == 0 || local.array() == 1).all();
}

/// The leaf cells of one configuration space. They are the cells between uniform lattice positions
/// that reach into the workspace ball. A split cell is replaced by its eighths that reach into the
/// ball, and so on. Together the leaves cover the whole ball.
///
/// A method that interpolates nodal data proceeds in three steps:
/// 1. take the data of solved slots from the space;
/// 2. fill those of the ghosts (viewer/fields/cell_data.hpp);
/// 3. fill those of the hanging slots in the order of hangingSlots(), each by evaluating the
///    interpolant in the slot's coarser leaf, whose corners are then complete (fillHanging).
///
/// The interpolant is then as continuous over the whole ball as between two cells of the uniform
/// lattice, under two conditions. Its restriction to a face must depend on the data of the face's
/// corners alone, and must be reproduced from its data at four points of the face. Tensor products
/// of Hermite polynomials satisfy both.
///
/// Immutable after construction, so any thread may read.
class CellTree {
 public:
  /// Copies the data it needs. Error if no point of the space is solved.
  explicit CellTree(const SpaceTable& space);

  /// Ordered by position in the cube of root cells, with the children of a split cell together.
  /// Never empty.
  const std::vector<LatticeCell>& leaves() const { return leaves_; }
  /// Returns the corners of a leaf by its index in leaves().
  const LeafCorners& corners(std::int32_t leaf) const { return corners_[at(leaf)]; }
  /// Edge length of a leaf, metres.
  double edge(std::int32_t leaf) const { return edge_[at(leaf)]; }
  /// Sorted by coordinates.
  const std::vector<CellSlot>& slots() const { return slots_; }
  /// Displacement of a slot, metres.
  Eigen::Vector3d displacement(std::int32_t slot) const;
  /// Hanging slots, coarse to fine: each comes after all hanging corners of its coarser leaf.
  const std::vector<std::int32_t>& hangingSlots() const { return hanging_; }
  double radius() const { return radius_; }              ///< of the ball, metres
  double spacing() const { return spacing_; }            ///< edge of the root cells, metres
  double unit() const { return spacing_ / divisions_; }  ///< metres per lattice coordinate
  /// Returns whether a leaf has no solved data: every corner is a ghost or hangs in an unsupported
  /// leaf.
  bool unsupported(std::int32_t leaf) const { return unsupported_[at(leaf)]; }

  /// Returns the leaf next to a lattice position in one of eight octants: bit `axis` of `octant` is
  /// set for the positive side. The leaf is -1 if there is none.
  LeafPlace leafBeside(const LatticePoint& point, std::size_t octant) const noexcept;
  /// Returns the leaf that contains a displacement of the closed ball; 1e-9 of the radius outside
  /// still counts as on it. The leaf is -1 for all others, including NaN. The time depends on the
  /// number of levels only. Real time: does not allocate, lock, throw or log.
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
  /// The cube of root cells, x slowest, then groups of eight eighths. An entry is the number of a
  /// leaf, no_cell outside the ball, or ~ the index of the first eighth.
  std::vector<std::int32_t> nodes_;
  std::vector<LatticeCell> leaves_;
  std::vector<double> edge_;
  std::vector<LeafCorners> corners_;
  std::vector<CellSlot> slots_;
  std::vector<std::int32_t> hanging_;
  std::vector<bool> unsupported_;
};

/// Returns the nearest displacement in the closed ball: itself, or the point of the sphere in its
/// direction; the origin for NaN. Finite for any input. Real time.
Eigen::Vector3d nearestInBall(const Eigen::Vector3d& displacement, double radius) noexcept;

/// Returns the trilinear weights of the eight corners at a place in a leaf. Real time.
inline std::array<double, 8> trilinearWeights(const Eigen::Vector3d& local) noexcept {
  std::array<double, 8> weights;
  for (std::size_t c = 0; c < 8; ++c)
    weights[c] = ((c & 1) != 0 ? local.x() : 1 - local.x()) *
                 ((c & 2) != 0 ? local.y() : 1 - local.y()) *
                 ((c & 4) != 0 ? local.z() : 1 - local.z());
  return weights;
}

/// Sets the values of all hanging slots, coarse to fine: values[slot] = evaluate(leaf, local).
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
