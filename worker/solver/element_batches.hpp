#pragma once

#include "worker/elements/element_kernels.hpp"
#include "worker/solver/body_model.hpp"
#include "worker/solver/dof_map.hpp"

namespace palpate {

/// As many elements of one material as the kernels take at once.
struct ElementBatch {
  BatchGeometry geometry;
  std::array<std::int32_t, lanes> element;  ///< -1 in lanes that are left over
  std::uint16_t material;
  int displacements, unknowns;  ///< local ones: of the displacement, and with those of the pressure

  /// Where the equation of a local unknown of the element in this lane is.
  Dof dofOf(int local_unknown, int lane) const {
    if (local_unknown < displacements)
      return {geometry.node[local_unknown / 3][lane], local_unknown % 3};
    return {geometry.pressure[local_unknown - displacements][lane], pressure_component};
  }
};

/// The elements of a body in batches, material by material, in the order of the mesh. Sums over
/// them are taken in this order.
struct ElementBatches {
  ElementBatches(const BodyModel& model, const PressureSlots& pressures);

  std::vector<ElementBatch> all;
  std::vector<std::vector<std::int32_t>> of_node;  ///< ascending, the batches that touch it

 private:
  void add(const BodyModel& model, const PressureSlots& pressures,
           const std::vector<std::int32_t>& elements, std::size_t first);
};

/// What the kernels need of the material and the spaces of each region. `pressure_scale` in Pa per
/// unit of q.
std::vector<ElementParameters> elementParameters(const BodyModel& model, double pressure_scale);

}  // namespace palpate
