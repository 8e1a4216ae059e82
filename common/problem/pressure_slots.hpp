#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/scene/formulation.hpp"
#include "common/scene/material.hpp"

namespace palpate {

/// Returns the number of nodes that have a pressure: 0, the number of vertices, or the number of
/// all nodes. These are the first nodes of the mesh.
std::size_t pressureNodes(PressureSpace space, const Mesh& mesh);

/// Numbers the nodal pressures of a body.
///
/// Pressure is continuous within a material but jumps between two materials, because the traction
/// is continuous while the stresses at equal strain differ. A node between materials therefore has
/// one pressure, called a slot, for each of them. Slot n < nodes() is the pressure at node n in the
/// material that the scene names first among those around the node. The slots of further materials
/// follow, sorted by node, then by material. Regions with equal materials share slots. Materials
/// that are not mixed (isMixed) have no pressure.
class PressureSlots {
 public:
  /// The slot of a further material at a node.
  struct Further {
    std::int32_t node;
    std::uint16_t region;  ///< the first region of this material
    auto operator<=>(const Further&) const = default;
  };

  PressureSlots() = default;  ///< a body without pressures
  /// `region_of` holds one index into `materials` per tetrahedron.
  PressureSlots(PressureSpace space, const Mesh& mesh, const std::vector<Material>& materials,
                const std::vector<std::uint16_t>& region_of);

  std::size_t count() const { return nodes() + further_.size(); }
  std::size_t nodes() const { return first_.size(); }  ///< number of nodes in the pressure space
  /// Returns the slot at a node for elements of `region`, which must have a pressure there.
  std::int32_t slotOf(std::int32_t node, std::uint16_t region) const;
  /// Returns the slots of the further materials at a node, ascending. They come in addition to the
  /// node's first slot, which has the number of the node.
  std::span<const Further> furtherAt(std::int32_t node) const;
  /// Returns the number of a slot that furtherAt() returned.
  std::int32_t numberOf(const Further& slot) const {
    return static_cast<std::int32_t>(nodes() + (&slot - further_.data()));
  }

 private:
  std::vector<std::uint16_t> same_as_;  ///< per region, the first region with an equal material
  std::vector<std::uint16_t> first_;    ///< per node, the region of its first slot
  std::vector<Further> further_;        ///< ascending
};

}  // namespace palpate
