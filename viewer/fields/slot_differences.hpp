#pragma once

#include "viewer/fields/cell_data.hpp"

namespace palpate {

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
  SlotDifferences(const CellData& data, Ghosts ghosts);

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

  /// d value / d axis at a slot: of the parabola through it and two others (error distance^2), of
  /// the line through one other, zero without any. `value(slot)` gives numbers or Eigen vectors.
  template <class Value>
  auto derivative(std::int32_t slot, int axis, Value value) const {
    const auto& [others, h] = stencil(slot, axis);
    auto result = value(slot);
    if (others[0] < 0) {
      result *= 0.0;
    } else if (others[1] < 0) {
      result = (value(others[0]) - result) / h[0];
    } else {
      const auto here = result;
      result = (value(others[0]) - here) * (h[1] / (h[0] * (h[1] - h[0]))) -
               (value(others[1]) - here) * (h[0] / (h[1] * (h[1] - h[0])));
    }
    return result;
  }

 private:
  std::int32_t neighbour(const CellData& data, std::int32_t slot, std::size_t axis, int direction,
                         std::int32_t level) const;
  Stencil choose(const CellData& data, std::int32_t slot, std::size_t axis, Ghosts ghosts) const;

  std::vector<std::int32_t> level_;                 ///< per slot; of the coarser leaf when hanging
  std::vector<std::vector<std::int32_t>> slots_;    ///< per level
  std::vector<std::vector<std::int32_t>> hanging_;  ///< per level
  std::vector<std::array<Stencil, 3>> stencils_;    ///< per slot; empty ones when hanging
};

}  // namespace palpate
