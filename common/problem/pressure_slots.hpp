#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/scene/formulation.hpp"
#include "common/scene/material.hpp"

namespace palpate {

/// Nodes that a pressure space has on a mesh, from number 0 on: none, the vertices, or all.
std::size_t pressureNodes(PressureSpace space, const Mesh& mesh);

/// The numbers that a body's pressure field consists of.
///
/// The pressure is continuous within a material. Between two materials it jumps, since the traction
/// is continuous and the stresses at equal strain differ, so that a node between them has one
/// pressure of each. Slots 0 to nodes() - 1 are those of the nodes of the pressure space, of the
/// material named first in the scene where there are several; the others follow, by node, then by
/// material. Regions of equal materials share their slots; materials without a pressure
/// (isMixed) have none.
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
  /// The slot of a node for an element of this region, which has a pressure there.
  std::int32_t slotOf(std::int32_t node, std::uint16_t region) const;
  /// The further slots of a node, ascending; its first one is its own number.
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
