#pragma once

#include <cstdint>
#include <vector>

#include "worker/solver/body_model.hpp"

namespace palpate {

/// A degree of freedom: a component of a node's displacement (0, 1, 2), or a pressure slot
/// (PressureSlots).
struct Dof {
  std::int32_t node;  ///< for a pressure its slot
  int component;
};
inline constexpr int pressure_component = 3;

/// Numbers the unknowns of a body, node by node: the displacements that are not fixed and the
/// pressures that have an equation. Fixed displacements have no number; displacements that a rigid
/// tool holds do have one (System).
class DofMap {
 public:
  DofMap(const BodyModel& model, const PressureSlots& slots);

  std::int32_t count() const { return count_; }
  std::int32_t pressures() const { return pressures_; }  ///< number of pressure unknowns
  /// Returns the number of an unknown; -1 if it has none.
  std::int32_t at(const Dof& place) const {
    const auto index = static_cast<std::size_t>(place.node);
    return place.component == pressure_component ? pressure_[index]
                                                 : displacement_[3 * index + place.component];
  }
  /// Returns the unknowns of a node, ascending.
  std::vector<std::int32_t> atNode(const PressureSlots& slots, std::int32_t node) const;

 private:
  std::int32_t count_ = 0, pressures_ = 0;
  std::vector<std::int32_t> displacement_;  ///< nNodes x 3
  std::vector<std::int32_t> pressure_;      ///< per slot
};

/// Returns the slots at these nodes (sorted) whose pressure is undetermined while a rigid tool
/// holds the nodes, ascending. All elements around such a slot move with the tool as a whole, so
/// their volume cannot change, and no stabilisation or bulk modulus gives the pressure a row.
std::vector<std::int32_t> idlePressures(const BodyModel& model, const PressureSlots& slots,
                                        const std::vector<std::int32_t>& tool_nodes);

}  // namespace palpate
