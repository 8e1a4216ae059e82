#pragma once

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/space/lattice.hpp"
#include "common/space/space_table.hpp"

namespace palpate {

/// Source of the nodal data of a slot (CellSlot).
enum class SlotKind : std::uint8_t {
  /// A lattice point with an equilibrium that interpolation uses (interpolatedPoints).
  solved,
  /// A position without a usable equilibrium: outside the ball, failed, or with too large a force.
  /// Its data are extrapolated from solved points.
  ghost,
  /// A position on the boundary of a coarser leaf, but not at one of its corners. Its data are
  /// taken from the interpolant in the coarser leaf, even if the position is solved. The
  /// interpolants of both leaves therefore agree on their common boundary.
  hanging,
};

/// The leaf that contains a displacement, and the place in it.
struct LeafPlace {
  std::int32_t leaf = -1;                           ///< -1 if outside the ball
  Eigen::Vector3d local = Eigen::Vector3d::Zero();  ///< coordinates in the leaf, 0..1
};

/// A vertex of the leaves. All leaves that meet at a slot share its nodal data, which makes
/// interpolants continuous.
struct CellSlot {
  LatticePoint point = {0, 0, 0};
  SlotKind kind = SlotKind::ghost;
  std::int32_t number = -1;  ///< lattice number if solved
  LeafPlace place = {};      ///< in the coarser leaf if hanging
};

/// Slots of the eight corners of a leaf. Corner c has offset (c & 1, c >> 1 & 1, c >> 2 & 1).
using LeafCorners = std::array<std::int32_t, 8>;

/// Returns whether is(lower end, upper end) is true for at least one edge of a leaf.
template <class Is>
bool anyEdge(const LeafCorners& corners, Is is) {
  for (std::size_t c = 0; c < 8; ++c)
    for (const std::size_t axis : {1, 2, 4})
      if ((c & axis) == 0 && is(corners[c], corners[c | axis])) return true;
  return false;
}

/// Returns whether a place in a leaf (coordinates 0..1) is one of the leaf's corners.
inline bool isCorner(const Eigen::Vector3d& local) noexcept {
  return (local.array() == 0 || local.array() == 1).all();
}

/// The octree of one configuration space. Its root cells are the cells of the uniform lattice that
/// reach into the workspace ball. The children of a split cell are its eighths that reach into the
/// ball, and so on. The cells without children are the leaves; together they cover the whole ball.
///
/// A method that interpolates nodal data proceeds in three steps:
/// 1. take the data of the solved slots from the space;
/// 2. extrapolate the data of the ghosts (viewer/fields/cell_data.hpp);
/// 3. compute the data of the hanging slots by evaluating, for each, the interpolant in its coarser
///    leaf (fillHanging). In the order of hangingSlots(), the corners of that leaf already have
///    their data.
///
/// The interpolant is then as continuous across leaves of different levels as it is between two
/// cells of the uniform lattice, under two conditions. First, on a face it must depend on the data
/// of the face's corners alone. Second, if data are taken from it at the corners of a part of the
/// face, interpolating these data must give the same function on this part. Tensor products of
/// Hermite polynomials satisfy both.
///
/// Immutable after construction, so any thread may read.
class CellTree {
 public:
  /// Copies the data it needs. Error if no point of the space is solved.
  explicit CellTree(const SpaceTable& space);

  /// All leaves (at least one), by root cell; the children of a split cell are together.
  const std::vector<LatticeCell>& leaves() const { return leaves_; }
  /// Returns the corners of a leaf by its index in leaves().
  const LeafCorners& corners(std::int32_t leaf) const { return corners_[at(leaf)]; }
  /// Edge length of a leaf, metres.
  double edge(std::int32_t leaf) const { return spacing_ / (1 << leaves_[at(leaf)].level); }
  /// All slots, sorted by coordinates.
  const std::vector<CellSlot>& slots() const { return slots_; }
  /// Displacement of a slot, metres.
  Eigen::Vector3d displacement(std::int32_t slot) const;
  /// Hanging slots, ordered by the level of their coarser leaf, coarse to fine. Each slot comes
  /// after the hanging corners of its own coarser leaf.
  const std::vector<std::int32_t>& hangingSlots() const { return hanging_; }
  double radius() const { return radius_; }              ///< radius of the ball, metres
  double spacing() const { return spacing_; }            ///< edge of the root cells, metres
  double unit() const { return spacing_ / divisions_; }  ///< metres per lattice coordinate
  /// Returns whether no solved data support a leaf: each corner is a ghost, or hangs in a coarser
  /// leaf that is unsupported too.
  bool unsupported(std::int32_t leaf) const { return unsupported_[at(leaf)]; }

  /// Returns the leaf that touches a lattice position from one of the eight octants around it. Bit
  /// `axis` of `octant` is set for the positive side of that axis. `leaf` is -1 if no leaf lies
  /// there.
  LeafPlace leafBeside(const LatticePoint& point, std::size_t octant) const noexcept;
  /// Returns the leaf that contains a displacement in the closed ball. Displacements outside the
  /// ball by up to 1e-9 of its radius count as on its surface. `leaf` is -1 for displacements
  /// farther outside and for NaN. The time depends on the number of levels only. Real time: does
  /// not allocate, lock, throw or log.
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
  std::int32_t extent_;  ///< number of root cells on each side of the origin, per axis
  /// The octree: first the cube of root cells, x slowest, then the eight children of each split
  /// cell. An entry is the number of a leaf, no_cell for a cell outside the ball, or the bitwise
  /// complement of the index of the first child.
  std::vector<std::int32_t> nodes_;
  std::vector<LatticeCell> leaves_;
  std::vector<LeafCorners> corners_;
  std::vector<CellSlot> slots_;
  std::vector<std::int32_t> hanging_;
  std::vector<bool> unsupported_;
};

/// Returns the displacement in the closed ball that is nearest to `displacement`: itself, or the
/// point of the sphere in its direction. Returns the origin for NaN. Finite for any input. Real
/// time.
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
  PALPATE_ASSERT(values.size() == tree.slots().size(), "each corner of a cell must have a value");
  for (const std::int32_t s : tree.hangingSlots()) {
    const CellSlot& slot = tree.slots()[at(s)];
    values[at(s)] = evaluate(slot.place.leaf, slot.place.local);
  }
}

}  // namespace palpate
