#include "common/problem/pressure_slots.hpp"

#include <algorithm>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/mesh/node_set.hpp"

namespace palpate {
namespace {

constexpr std::uint16_t no_region = std::numeric_limits<std::uint16_t>::max();

}  // namespace

std::size_t pressureNodes(PressureSpace space, const Mesh& mesh) {
  switch (space) {
    case PressureSpace::none: return 0;
    case PressureSpace::p1:
    case PressureSpace::p1_stabilized: return at(mesh.vertices());
    case PressureSpace::p2: return mesh.nodes.size();
  }
  return 0;
}

PressureSlots::PressureSlots(PressureSpace space, const Mesh& mesh,
                             const std::vector<Material>& materials,
                             const std::vector<std::uint16_t>& region_of)
    : first_(pressureNodes(space, mesh), no_region) {
  if (first_.empty()) return;
  PALPATE_ASSERT(region_of.size() == mesh.tetrahedra.size(), "each tetrahedron must have a region");
  for (const Material& material : materials)
    same_as_.push_back(
        static_cast<std::uint16_t>(std::ranges::find(materials, material) - materials.begin()));
  const auto forEachPlace = [&](const auto& visit) {
    for (std::size_t element = 0; element < mesh.tetrahedra.size(); ++element) {
      if (!isMixed(materials[region_of[element]])) continue;
      const std::uint16_t region = same_as_[region_of[element]];
      for (const std::int32_t node : mesh.tetrahedra[element]) visit(node, region);
      if (space != PressureSpace::p2) continue;
      for (const std::int32_t node : mesh.mid_edge_nodes[element]) visit(node, region);
    }
  };
  forEachPlace([&](std::int32_t node, std::uint16_t region) {
    first_[at(node)] = std::min(first_[at(node)], region);
  });
  forEachPlace([&](std::int32_t node, std::uint16_t region) {
    if (first_[at(node)] != region) further_.push_back({node, region});
  });
  sortUnique(further_);
}

std::int32_t PressureSlots::slotOf(std::int32_t node, std::uint16_t region) const {
  const Further wanted{node, same_as_[region]};
  if (first_[at(node)] == wanted.region) return node;
  const auto found = std::ranges::lower_bound(further_, wanted);
  PALPATE_ASSERT(found != further_.end() && *found == wanted,
                 "each node of an element must have a pressure");
  return numberOf(*found);
}

std::span<const PressureSlots::Further> PressureSlots::furtherAt(std::int32_t node) const {
  return {std::ranges::lower_bound(further_, node, {}, &Further::node),
          std::ranges::upper_bound(further_, node, {}, &Further::node)};
}

}  // namespace palpate
