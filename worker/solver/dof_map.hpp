#pragma once

#include <cstdint>
#include <vector>

#include "worker/solver/body_model.hpp"

namespace palpate {

/// Where an equation is: at a node, for a component of its displacement (0, 1, 2), or at a slot of
/// the pressures (PressureSlots).
struct Dof {
  std::int32_t node;  ///< the slot where the component is the pressure
  int component;
};
inline constexpr int pressure_component = 3;

/// The numbers of the unknowns of a body: the displacements that are not fixed and the pressures
/// that have an equation, node by node. Dirichlet values have none, what a rigid tool holds has
/// (System).
class DofMap {
 public:
  DofMap(const BodyModel& model, const PressureSlots& slots);

  std::int32_t count() const { return count_; }
  std::int32_t pressures() const { return pressures_; }  ///< unknowns among them
  /// -1 where there is none.
  std::int32_t at(const Dof& place) const {
    const auto index = static_cast<std::size_t>(place.node);
    return place.component == pressure_component ? pressure_[index]
                                                 : displacement_[3 * index + place.component];
  }
  /// All of a node, ascending.
  std::vector<std::int32_t> atNode(const PressureSlots& slots, std::int32_t node) const;

 private:
  std::int32_t count_ = 0, pressures_ = 0;
  std::vector<std::int32_t> displacement_;  ///< nNodes x 3
  std::vector<std::int32_t> pressure_;      ///< per slot
};

/// The slots at these nodes (sorted) whose pressure says nothing while a rigid tool holds them: all
/// elements around move with it as a whole, so that no volume can change, and neither a
/// stabilisation nor a bulk modulus gives the pressure a row of its own. Ascending.
std::vector<std::int32_t> idlePressures(const BodyModel& model, const PressureSlots& slots,
                                        const std::vector<std::int32_t>& tool_nodes);

}  // namespace palpate
