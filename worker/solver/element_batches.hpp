#pragma once

#include "worker/elements/element_kernels.hpp"
#include "worker/solver/body_model.hpp"
#include "worker/solver/dof_map.hpp"

namespace palpate {

/// A batch of `lanes` elements of one material, evaluated together by the kernels.
struct ElementBatch {
  BatchGeometry geometry;
  std::array<std::int32_t, lanes> element;  ///< element in each lane; -1 if the lane is unused
  std::uint16_t material;
  /// Local unknowns per element: number of displacement components, and number of all unknowns.
  int displacements, unknowns;

  /// Returns the degree of freedom of a local unknown of the element in this lane.
  Dof dofOf(int local_unknown, int lane) const {
    if (local_unknown < displacements)
      return {geometry.node[local_unknown / 3][lane], local_unknown % 3};
    return {geometry.pressure[local_unknown - displacements][lane], pressure_component};
  }
};

/// The elements of a body in batches, material by material, in mesh order. Sums over elements are
/// taken in this order.
struct ElementBatches {
  ElementBatches(const BodyModel& model, const PressureSlots& pressures);

  std::vector<ElementBatch> all;
  std::vector<std::vector<std::int32_t>> of_node;  ///< batches that contain each node, ascending

 private:
  void add(const BodyModel& model, const PressureSlots& pressures,
           const std::vector<std::int32_t>& elements, std::size_t first);
};

/// Returns the kernel parameters of each region, from its material and the function spaces of its
/// elements. `pressure_scale`: Pa per unit of q.
std::vector<ElementParameters> elementParameters(const BodyModel& model, double pressure_scale);

}  // namespace palpate
