#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/scene/formulation.hpp"
#include "common/scene/material.hpp"

namespace palpate {

/// How many nodes of the mesh, from node 0 on, have a pressure: none, the vertices, or all.
std::size_t pressureNodes(PressureSpace space, const Mesh& mesh);

/// Numbers the nodal pressures of a body.
///
/// The pressure is continuous within a material and jumps between two: the traction is continuous,
/// and the stresses at equal strain differ. A node between two materials therefore has a pressure
/// for each. Slot n < nodes() is the pressure at node n for the material that the scene names first
/// there. The pressures of further materials follow, by node, then by material. Regions of equal
/// materials share slots. Materials that are not mixed (isMixed) have no pressure.
class PressureSlots {
 public:
  /// The pressure of a further material at a node.
  struct Further {
    std::int32_t node;
    std::uint16_t region;  ///< the first one of this material
    auto operator<=>(const Further&) const = default;
  };

  PressureSlots() = default;  ///< of a body without pressures
  /// `region_of`: per tetrahedron, index into `materials`.
  PressureSlots(PressureSpace space, const Mesh& mesh, const std::vector<Material>& materials,
                const std::vector<std::uint16_t>& region_of);

  std::size_t count() const { return nodes() + further_.size(); }
  std::size_t nodes() const { return first_.size(); }  ///< of the pressure space
  /// The slot at a node for elements of this region. They have a pressure there.
  std::int32_t slotOf(std::int32_t node, std::uint16_t region) const;
  /// The further materials at a node, ascending. Its first slot is its own number.
  std::span<const Further> furtherAt(std::int32_t node) const;
  /// The number of a slot from furtherAt().
  std::int32_t numberOf(const Further& slot) const {
    return static_cast<std::int32_t>(nodes() + (&slot - further_.data()));
  }

 private:
  std::vector<std::uint16_t> same_as_;  ///< per region, the first region of the same material
  std::vector<std::uint16_t> first_;    ///< per node, the region of its own slot
  std::vector<Further> further_;        ///< ascending
};

}  // namespace palpate
