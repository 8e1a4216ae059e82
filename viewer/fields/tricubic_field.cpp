#include "viewer/fields/tricubic_field.hpp"

#include <algorithm>
#include <limits>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

using Node = TricubicField::Node;

/// Interpolates between the nodes at two ends of an edge along `axis`. `local`: place in the leaf,
/// 0..1; edge: metres. In the result, columns with bit `axis` are derivatives along the edge; the
/// others are values.
template <int axis>
Node cubicAlong(const Node& low, const Node& high, const Eigen::Vector3d& local, double edge) {
  constexpr int bit = 1 << axis;
  const double t = local[axis], s = 1 - t;
  const double value[4] = {s * s * (1 + 2 * t), edge * t * s * s, t * t * (1 + 2 * s),
                           -edge * s * t * t};
  const double slope[4] = {-6 * t * s / edge, s * (1 - 3 * t), 6 * t * s / edge, t * (1 - 3 * s)};
  Node result;
  for (int column = 0; column < 8; ++column) {
    const double* basis = (column & bit) == 0 ? value : slope;
    const int flat = column & ~bit, steep = column | bit;
    result.col(column) = basis[0] * low.col(flat) + basis[1] * low.col(steep) +
                         basis[2] * high.col(flat) + basis[3] * high.col(steep);
  }
  return result;
}

/// Returns all eight derivatives of the interpolant at a place in a leaf.
Node tricubicAt(const LeafCorners& corners, const std::vector<Node>& nodes,
                const Eigen::Vector3d& local, double edge) {
  Node faces[2];
  for (std::size_t z = 0; z < 2; ++z) {
    Node lines[2];
    for (std::size_t y = 0; y < 2; ++y)
      lines[y] = cubicAlong<0>(nodes[at(corners[2 * y + 4 * z])],
                               nodes[at(corners[2 * y + 4 * z + 1])], local, edge);
    faces[z] = cubicAlong<1>(lines[0], lines[1], local, edge);
  }
  return cubicAlong<2>(faces[0], faces[1], local, edge);
}

/// Finite-difference stencils between slots, and the order in which they can be evaluated on a
/// refined tree.
///
/// A slot (grid vertex) has the level of the coarsest leaf of which it is a corner. A hanging slot
/// has the level of the coarser leaf from which it is interpolated. Along each axis, the neighbour
/// of a slot is the slot one edge length away. The edge length is that of the slot's own level or,
/// if no slot is there, of the next coarser level that has one. A slot thus never depends on finer
/// levels, so levels can be evaluated from coarse to fine.
class SlotDifferences {
 public:
  /// `data` must outlive this object.
  explicit SlotDifferences(const CellData& data)
      : data_(data), level_(data.tree.slots().size(), std::numeric_limits<std::int32_t>::max()) {
    const CellTree& tree = data.tree;
    for (std::int32_t leaf = 0; leaf < std::ssize(tree.leaves()); ++leaf)
      for (const std::int32_t slot : tree.corners(leaf))
        level_[at(slot)] = std::min(level_[at(slot)], tree.leaves()[at(leaf)].level);
    for (const std::int32_t slot : tree.hangingSlots())
      level_[at(slot)] = tree.leaves()[at(tree.slots()[at(slot)].place.leaf)].level;
    for (std::int32_t slot = 0; slot < std::ssize(level_); ++slot)
      for (int axis = 0; axis < 3; ++axis) stencils_.push_back(stencilOf(slot, axis));
  }

  std::int32_t level(std::int32_t slot) const { return level_[at(slot)]; }
  std::int32_t deepest() const { return *std::ranges::max_element(level_); }

  /// Returns the slots that the derivative along an axis uses besides `slot`: two, one (the second
  /// is -1) or none (both are -1). Hanging slots have none. The other end of an inconsistent edge
  /// is never used.
  const std::array<std::int32_t, 2>& stencil(std::int32_t slot, int axis) const {
    return stencils_[3 * at(slot) + at(axis)];
  }

  /// Returns d column / d axis at a slot. With two other slots the derivative is the slope of the
  /// parabola through the three values; the error is proportional to distance^2. With one other
  /// slot it is the slope of a line, and without others it is zero.
  Eigen::Vector4d derivative(const std::vector<Node>& nodes, int column, std::int32_t slot,
                             int axis) const {
    const auto [first, second] = stencil(slot, axis);
    const auto change = [&](std::int32_t other) -> Eigen::Vector4d {
      return nodes[at(other)].col(column) - nodes[at(slot)].col(column);
    };
    const auto step = [&](std::int32_t other) {  // metres, signed
      return (data_.tree.displacement(other) - data_.tree.displacement(slot))[axis];
    };
    if (first < 0) return Eigen::Vector4d::Zero();
    const double h = step(first);
    if (second < 0) return change(first) / h;
    const double g = step(second);
    return (change(first) * (g / h) - change(second) * (h / g)) / (g - h);
  }

 private:
  bool hangs(std::int32_t slot) const {
    return data_.tree.slots()[at(slot)].kind == SlotKind::hanging;
  }

  /// Returns the nearest slot in a direction, among the slots whose data are known when `slot` is
  /// evaluated; -1 if there is none.
  std::int32_t neighbour(std::int32_t slot, int axis, int direction, std::int32_t level) const {
    // Tries the edge length of `level` first, then longer ones, because the neighbour may belong
    // only to coarser leaves.
    for (std::int32_t l = level; l >= 0; --l) {
      LatticePoint point = data_.tree.slots()[at(slot)].point;
      point[at(axis)] += direction * (data_.divisions >> l);
      const std::int32_t other = data_.slotAt(point);
      if (other >= 0 && level_[at(other)] + (hangs(other) ? 1 : 0) <= level)
        return data_.isInconsistent(slot, other) ? -1 : other;
    }
    return -1;
  }

  std::array<std::int32_t, 2> stencilOf(std::int32_t slot, int axis) const {
    if (hangs(slot)) return {-1, -1};
    const std::int32_t level = level_[at(slot)];
    const std::int32_t lower = neighbour(slot, axis, -1, level),
                       upper = neighbour(slot, axis, 1, level);
    if (lower >= 0 && upper >= 0) return {lower, upper};
    // A one-sided difference also uses the neighbour's neighbour.
    if (upper >= 0) return {upper, neighbour(upper, axis, 1, level)};
    return {lower, lower < 0 ? -1 : neighbour(lower, axis, -1, level)};
  }

  const CellData& data_;
  std::vector<std::int32_t> level_;                    ///< per slot
  std::vector<std::array<std::int32_t, 2>> stencils_;  ///< per slot and axis
};

std::vector<Node> makeNodes(const CellData& data) {
  const CellTree& tree = data.tree;
  const SlotDifferences differences(data);
  const auto count = static_cast<std::int32_t>(tree.slots().size());
  std::vector<Node> nodes(at(count), Node::Zero());
  for (std::int32_t slot = 0; slot < count; ++slot)
    nodes[at(slot)].col(0).head<3>() = data.equilibria[at(slot)].force;
  for (std::int32_t level = 0; level <= differences.deepest(); ++level) {
    // A mixed derivative is the finite difference, along its last axis, of the derivative without
    // that axis.
    for (const int column : {1, 2, 4, 3, 5, 6, 7}) {
      const int axis = column >= 4 ? 2 : column >= 2 ? 1 : 0;
      for (std::int32_t slot = 0; slot < count; ++slot)
        if (differences.level(slot) == level)
          nodes[at(slot)].col(column) =
              differences.derivative(nodes, column & ~(1 << axis), slot, axis);
    }
    for (const std::int32_t slot : tree.hangingSlots())
      if (const LeafPlace& hanging = tree.slots()[at(slot)].place; differences.level(slot) == level)
        nodes[at(slot)] =
            tricubicAt(tree.corners(hanging.leaf), nodes, hanging.local, tree.edge(hanging.leaf));
  }
  return nodes;
}

/// Lowers the coverage of each slot to the least coverage of the slots in its stencils.
const CellData& withStencilSupport(CellData& data) {
  const SlotDifferences differences(data);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> before = data.support;
    for (std::size_t s = 0; s < before.size(); ++s)
      for (const std::int32_t other : differences.stencil(static_cast<std::int32_t>(s), axis))
        if (other >= 0) data.support[s] = std::min(data.support[s], before[at(other)]);
  }
  return data;
}

}  // namespace

TricubicField::TricubicField(CellData data)
    : CellField("tricubic", withStencilSupport(data)), nodes_(makeNodes(data)) {
  PALPATE_ASSERT(nodes_.size() == tree().slots().size(), "each corner of a cell needs derivatives");
}

void TricubicField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                                ForceSample& sample) const noexcept {
  const Node node = tricubicAt(tree().corners(leaf), nodes_, local, tree().edge(leaf));
  sample.force = node.col(0).head<3>();
  sample.stiffness << node.col(1).head<3>(), node.col(2).head<3>(), node.col(4).head<3>();
}

}  // namespace palpate
