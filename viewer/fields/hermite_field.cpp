#include "viewer/fields/hermite_field.hpp"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

using Node = HermiteField::Node;
using Column = Eigen::Vector4d;

/// Cubic Hermite basis of a leaf along one axis, and its slope per metre: [derivative][2 * end +
/// order].
using Basis = std::array<std::array<double, 4>, 2>;

/// local: 0..1; edge: metres.
Basis cubicHermite(double local, double edge) {
  const double t = local, s = 1 - local;
  Basis basis;
  basis[0] = {s * s * (1 + 2 * t), edge * t * s * s, t * t * (1 + 2 * s), -edge * s * t * t};
  basis[1] = {-6 * t * s / edge, s * (1 - 3 * t), 6 * t * s / edge, t * (1 - 3 * s)};
  return basis;
}

Column combine(const std::array<double, 4>& basis, const Column& low, const Column& low_slope,
               const Column& high, const Column& high_slope) {
  return basis[0] * low + basis[1] * low_slope + basis[2] * high + basis[3] * high_slope;
}
Column combine(const std::array<double, 4>& basis, const Column (&ends)[4]) {
  return combine(basis, ends[0], ends[1], ends[2], ends[3]);
}

/// The interpolant and its first derivatives at a place: columns value, d/dx, d/dy, d/dz.
struct Jet {
  Column value, dx, dy, dz;
};

Jet evaluateLeaf(const LeafCorners& corners, const std::vector<Node>& nodes,
                 const Eigen::Vector3d& local, double edge) {
  const Basis x = cubicHermite(local.x(), edge), y = cubicHermite(local.y(), edge),
              z = cubicHermite(local.z(), edge);
  // Along x first: [derivative of x][order of y], then along y, then along z.
  Column value[4], dx[4], dy[4];  // [2 * z end + order of z]
  for (std::size_t z_end = 0; z_end < 2; ++z_end)
    for (std::size_t z_order = 0; z_order < 2; ++z_order) {
      Column lines[4], slopes[4];  // [2 * y end + order of y]
      for (std::size_t y_end = 0; y_end < 2; ++y_end) {
        const Node& low = nodes[at(corners[2 * y_end + 4 * z_end])];
        const Node& high = nodes[at(corners[2 * y_end + 4 * z_end + 1])];
        for (std::size_t y_order = 0; y_order < 2; ++y_order) {
          const std::size_t column = 2 * y_order + 4 * z_order;
          lines[2 * y_end + y_order] = combine(x[0], low.col(column), low.col(column + 1),
                                               high.col(column), high.col(column + 1));
          slopes[2 * y_end + y_order] = combine(x[1], low.col(column), low.col(column + 1),
                                                high.col(column), high.col(column + 1));
        }
      }
      const std::size_t at_z = 2 * z_end + z_order;
      value[at_z] = combine(y[0], lines);
      dx[at_z] = combine(y[0], slopes);
      dy[at_z] = combine(y[1], lines);
    }
  return {combine(z[0], value), combine(z[0], dx), combine(z[0], dy), combine(z[1], value)};
}

/// All eight derivatives of the interpolant at a place. Not for real time.
Node evaluateNode(const LeafCorners& corners, const std::vector<Node>& nodes,
                  const Eigen::Vector3d& local, double edge) {
  const Basis bases[3] = {cubicHermite(local.x(), edge), cubicHermite(local.y(), edge),
                          cubicHermite(local.z(), edge)};
  Node result = Node::Zero();
  for (std::size_t derivative = 0; derivative < 8; ++derivative)
    for (std::size_t corner = 0; corner < 8; ++corner)
      for (std::size_t order = 0; order < 8; ++order) {
        double factor = 1;
        for (std::size_t axis = 0; axis < 3; ++axis)
          factor *=
              bases[axis][derivative >> axis & 1][2 * (corner >> axis & 1) + (order >> axis & 1)];
        result.col(derivative) += factor * nodes[at(corners[corner])].col(order);
      }
  return result;
}

bool isSolvedSlot(const CellTree& tree, std::int32_t slot) {
  return tree.slots()[at(slot)].kind == SlotKind::solved;
}

/// Derivatives of nodal data by differences between slots, one value per slot, and the order in
/// which they can be had on a refined tree.
///
/// A slot that does not hang has the level of the coarsest leaf it is a corner of. Its neighbours
/// along an axis are the nearest slots at the distance of an edge of that leaf or of coarser ones,
/// so their data are those of this or a coarser level, also where they hang: levels are made one
/// after the other.
class SlotDifferences {
 public:
  /// Which neighbours a difference may use where some are not solved.
  enum class Ghosts {
    any,        ///< all
    if_needed,  ///< a solved slot only uses solved ones, unless it has none along the axis
  };

  /// `data` must outlive it.
  SlotDifferences(const CellData& data, Ghosts ghosts)
      : level_(data.tree.slots().size(), std::numeric_limits<std::int32_t>::max()) {
    const CellTree& tree = data.tree;
    std::int32_t deepest = 0;
    for (std::int32_t leaf = 0; leaf < std::ssize(tree.leaves()); ++leaf) {
      const std::int32_t level = tree.leaves()[at(leaf)].level;
      deepest = std::max(deepest, level);
      for (const std::int32_t slot : tree.corners(leaf))
        level_[at(slot)] = std::min(level_[at(slot)], level);
    }
    slots_.resize(at(deepest) + 1);
    hanging_.resize(at(deepest) + 1);
    for (const std::int32_t slot : tree.hangingSlots()) {
      level_[at(slot)] = tree.leaves()[at(tree.slots()[at(slot)].leaf)].level;
      hanging_[at(level_[at(slot)])].push_back(slot);
    }
    PALPATE_ASSERT(data.numbers.size() == tree.slots().size(),
                   "jumps are found by the lattice numbers of slots");
    stencils_.resize(tree.slots().size());
    for (std::size_t s = 0; s < stencils_.size(); ++s) {
      if (tree.slots()[s].kind == SlotKind::hanging) continue;
      const auto slot = static_cast<std::int32_t>(s);
      slots_[at(level_[s])].push_back(slot);
      for (std::size_t axis = 0; axis < 3; ++axis)
        stencils_[s][axis] = choose(data, slot, axis, ghosts);
    }
  }

  /// Of the tree: 1 when no cell is split.
  std::int32_t levels() const { return static_cast<std::int32_t>(slots_.size()); }
  /// Those that do not hang and have this level.
  const std::vector<std::int32_t>& slots(std::int32_t level) const { return slots_[at(level)]; }
  /// Those that hang in a leaf of this level, in an order in which they can be filled.
  const std::vector<std::int32_t>& hanging(std::int32_t level) const { return hanging_[at(level)]; }

  /// The slots that the derivative of a slot along an axis uses beside itself; -1 for none. Never
  /// the end of an inconsistent edge to it.
  struct Stencil {
    std::array<std::int32_t, 2> slots = {-1, -1};
    std::array<double, 2> distances = {0, 0};  ///< metres, signed
  };
  /// Of a slot that does not hang, along axis 0, 1 or 2.
  const Stencil& stencil(std::int32_t slot, int axis) const {
    return stencils_[at(slot)][at(axis)];
  }

  /// d value / d axis at a slot that has a neighbour along it: of the parabola through it and two
  /// others (error distance^2), of the line through one other. `value(slot)` gives a Column.
  template <class Value>
  Column derivative(std::int32_t slot, int axis, Value value) const {
    const auto& [others, h] = stencil(slot, axis);
    const Column here = value(slot);
    if (others[1] < 0) return (value(others[0]) - here) / h[0];
    return (value(others[0]) - here) * (h[1] / (h[0] * (h[1] - h[0]))) -
           (value(others[1]) - here) * (h[0] / (h[1] * (h[1] - h[0])));
  }

 private:
  /// The nearest slot in a direction whose data exist when `level` is made; -1 for none.
  std::int32_t neighbour(const CellData& data, std::int32_t slot, std::size_t axis, int direction,
                         std::int32_t level) const {
    const CellTree& tree = data.tree;
    const std::int32_t root = data.divisions;
    // From the edge of the slot's own leaves up: the neighbour may belong to coarser ones only.
    for (std::int32_t l = level; l >= 0; --l) {
      LatticePoint point = tree.slots()[at(slot)].point;
      point[axis] += direction * (root >> l);
      const std::int32_t other = data.slotAt(point);
      if (other < 0 || level_[at(other)] > level ||
          (level_[at(other)] == level && tree.slots()[at(other)].kind == SlotKind::hanging))
        continue;
      return data.isInconsistent(slot, other) ? -1 : other;
    }
    return -1;
  }

  Stencil choose(const CellData& data, std::int32_t slot, std::size_t axis, Ghosts ghosts) const {
    const CellTree& tree = data.tree;
    const std::int32_t level = level_[at(slot)];
    std::int32_t lower = neighbour(data, slot, axis, -1, level),
                 upper = neighbour(data, slot, axis, 1, level);
    if (ghosts == Ghosts::if_needed && isSolvedSlot(tree, slot)) {
      const auto isGhost = [&](std::int32_t other) {
        return other >= 0 && tree.slots()[at(other)].kind == SlotKind::ghost;
      };
      if (isGhost(lower) && upper >= 0 && !isGhost(upper)) lower = -1;
      if (isGhost(upper) && lower >= 0 && !isGhost(lower)) upper = -1;
    }
    Stencil stencil;
    std::array<std::int32_t, 2> chosen = {lower, upper};
    if ((lower < 0) !=
        (upper < 0)) {  // one-sided: with the neighbour's neighbour, if that is as good
      const int direction = upper < 0 ? -1 : 1;
      const std::int32_t near = std::max(lower, upper);
      const std::int32_t far = neighbour(data, near, axis, direction, level);
      const bool usable = far >= 0 && (ghosts == Ghosts::any || isSolvedSlot(tree, far) ||
                                       !isSolvedSlot(tree, slot));
      chosen = {near, usable ? far : -1};
    }
    for (std::size_t n = 0; n < 2; ++n) {
      if (chosen[n] < 0) continue;
      stencil.slots[n] = chosen[n];
      stencil.distances[n] = (tree.displacement(chosen[n]) - tree.displacement(slot))[axis];
    }
    return stencil;
  }

  std::vector<std::int32_t> level_;                 ///< per slot; of the coarser leaf when hanging
  std::vector<std::vector<std::int32_t>> slots_;    ///< per level
  std::vector<std::vector<std::int32_t>> hanging_;  ///< per level
  std::vector<std::array<Stencil, 3>> stencils_;    ///< per slot; empty ones when hanging
};

/// Sets derivative `orders` (a bit per axis) of the slots of a level: the mean of the differences,
/// along each of its axes, of the derivative without that axis.
void difference(const SlotDifferences& differences, std::int32_t level, unsigned orders,
                std::vector<Node>& nodes) {
  for (const std::int32_t slot : differences.slots(level)) {
    Column sum = Column::Zero();
    int count = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if ((orders >> axis & 1) == 0 || differences.stencil(slot, axis).slots[0] < 0) continue;
      const unsigned lower = orders & ~(1U << axis);
      sum += differences.derivative(
          slot, axis, [&](std::int32_t s) -> Column { return nodes[at(s)].col(lower); });
      ++count;
    }
    nodes[at(slot)].col(orders) = count > 0 ? Column(sum / count) : Column::Zero();
  }
}

std::vector<Node> makeNodes(const CellData& data, HermiteField::Slopes slopes) {
  const bool exact = slopes == HermiteField::Slopes::exact;
  std::vector<Node> nodes(data.equilibria.size(), Node::Zero());
  for (std::size_t s = 0; s < nodes.size(); ++s) {
    const Equilibrium& equilibrium = data.equilibria[s];
    nodes[s].col(0).head<3>() = equilibrium.force;
    if (exact)
      for (int axis = 0; axis < 3; ++axis)
        nodes[s].col(1 << axis).head<3>() = equilibrium.stiffness.col(axis);
  }
  PALPATE_ASSERT(nodes.size() == data.tree.slots().size(), "nodal data belong to slots");
  // Mixed derivatives of solved slots stay free of ghosts where the stiffnesses are exact.
  const SlotDifferences differences(
      data, exact ? SlotDifferences::Ghosts::if_needed : SlotDifferences::Ghosts::any);
  for (std::int32_t level = 0; level < differences.levels(); ++level) {
    if (!exact)
      for (const unsigned orders : {1U, 2U, 4U}) difference(differences, level, orders, nodes);
    for (const unsigned orders : {3U, 5U, 6U, 7U}) difference(differences, level, orders, nodes);
    for (const std::int32_t slot : differences.hanging(level)) {
      const CellSlot& hanging = data.tree.slots()[at(slot)];
      nodes[at(slot)] = evaluateNode(data.tree.corners(hanging.leaf), nodes, hanging.local,
                                     data.tree.edge(hanging.leaf));
    }
  }
  return nodes;
}

/// Of differences of the forces: lowers the support of slots whose differences use ghosts.
const CellData& withStencilSupport(CellData& data, HermiteField::Slopes slopes) {
  if (slopes == HermiteField::Slopes::exact) return data;
  const SlotDifferences differences(data, SlotDifferences::Ghosts::any);
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> before = data.support;
    for (std::size_t s = 0; s < before.size(); ++s) {
      const auto& stencil = differences.stencil(static_cast<std::int32_t>(s), axis);
      for (const std::int32_t other : stencil.slots)
        if (other >= 0) data.support[s] = std::min(data.support[s], before[at(other)]);
    }
  }
  return data;
}

}  // namespace

HermiteField::HermiteField(CellData data, Slopes slopes)
    : CellField(slopes == Slopes::exact ? "hermite" : "tricubic", withStencilSupport(data, slopes)),
      nodes_(makeNodes(data, slopes)) {}

void HermiteField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                               ForceSample& sample) const noexcept {
  const Jet jet = evaluateLeaf(tree().corners(leaf), nodes_, local, tree().edge(leaf));
  sample.force = jet.value.head<3>();
  sample.stiffness << jet.dx.head<3>(), jet.dy.head<3>(), jet.dz.head<3>();
}

}  // namespace palpate
