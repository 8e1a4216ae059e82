#pragma once

#include <cstdint>
#include <vector>

#include "worker/solver/body_model.hpp"

namespace palpate {

/// A degree of freedom: a component of a node's displacement (0, 1, 2), or a pressure slot
/// (PressureSlots).
struct Dof {
  std::int32_t node;  ///< node number; for a pressure, the slot number
  int component;
};
inline constexpr int pressure_component = 3;

/// Numbers the unknowns of a body, node by node. Unknowns are the displacements that are not fixed,
/// and the pressures that have an equation. Displacements that a rigid tool holds also have a
/// number (System).
class DofMap {
 public:
  DofMap(const BodyModel& model, const PressureSlots& slots);

  std::int32_t count() const { return count_; }
  std::int32_t pressures() const { return pressures_; }  ///< number of pressure unknowns
  /// Returns the number of a degree of freedom; -1 if it is not an unknown.
  std::int32_t at(const Dof& place) const {
    const auto index = static_cast<std::size_t>(place.node);
    return place.component == pressure_component ? pressure_[index]
                                                 : displacement_[3 * index + place.component];
  }
  /// Returns the numbers of the unknowns of a node, ascending.
  std::vector<std::int32_t> atNode(const PressureSlots& slots, std::int32_t node) const;

 private:
  std::int32_t count_ = 0, pressures_ = 0;
  std::vector<std::int32_t> displacement_;  ///< nNodes x 3
  std::vector<std::int32_t> pressure_;      ///< per slot
};

/// Returns, in ascending order, those pressure slots of `tool_nodes` (sorted) whose pressure no
/// equation determines while a rigid tool holds these nodes. All elements that share such a slot
/// move with the tool as a rigid body. So their volume cannot change, and neither a stabilisation
/// nor a bulk modulus adds an equation for the pressure.
std::vector<std::int32_t> idlePressures(const BodyModel& model, const PressureSlots& slots,
                                        const std::vector<std::int32_t>& tool_nodes);

}  // namespace palpate
