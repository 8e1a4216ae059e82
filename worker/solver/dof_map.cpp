#include "worker/solver/dof_map.hpp"

#include <algorithm>

#include "common/base/index.hpp"
#include "common/base/joined_sets.hpp"
#include "common/mesh/tetrahedron.hpp"
#include "worker/elements/element_kernels.hpp"

namespace palpate {
namespace {

/// Returns 1 for each node that is fixed in all directions.
std::vector<std::uint8_t> fixedNodes(const BodyModel& model) {
  std::vector<std::uint8_t> fixed(model.mesh.nodes.size());
  for (std::size_t node = 0; node < fixed.size(); ++node) {
    const std::uint8_t* of_node = &model.fixed[3 * node];
    fixed[node] = of_node[0] && of_node[1] && of_node[2] ? 1 : 0;
  }
  return fixed;
}

/// Finds the pressures that have an equation while some nodes are held.
class DeterminedPressures {
 public:
  DeterminedPressures(const BodyModel& model, const PressureSlots& slots,
                      const std::vector<std::uint8_t>& held)
      : model_(model),
        slots_(slots),
        held_(held),
        determined_(slots.count(), 0),
        pieces_(slots.count()) {}

  /// Returns 1 for each slot whose pressure has an equation. `of_held`: whether compressible
  /// elements without a free node also give their pressures an equation.
  std::vector<std::uint8_t> find(bool of_held) {
    std::vector<std::int32_t> moving;  // slots of stabilised elements that have a free node
    for (std::size_t element = 0; element < model_.mesh.tetrahedra.size(); ++element) {
      const std::uint16_t region = model_.region_of[element];
      const PressureSpace space = pressureSpaceOf(model_, region);
      const std::vector<std::int32_t> nodes = nodesOf(model_.mesh, element);
      const bool moves =
          std::ranges::any_of(nodes, [&](std::int32_t node) { return !held_[at(node)]; });
      const bool incompressible = isIncompressible(model_.materials[region]);
      for (int b = 0; b < pressureNodes(space); ++b) {
        const std::int32_t slot = slots_.slotOf(nodes[at(b)], region);
        if (space == PressureSpace::p1_stabilized) {
          pieces_.join(slot, slots_.slotOf(nodes.front(), region));
          if (moves) moving.push_back(slot);
        } else if (incompressible ? changesVolume(nodes, space, b) : moves || of_held) {
          determined_[at(slot)] = 1;
        }
      }
    }
    spread(moving);
    return std::move(determined_);
  }

 private:
  /// Returns whether the free nodes of an element can change its volume, weighted by the pressure's
  /// shape function b. In Taylor-Hood elements a free vertex suffices for every b. A free mid-edge
  /// node suffices only if b is an end of its edge.
  bool changesVolume(const std::vector<std::int32_t>& nodes, PressureSpace space, int b) const {
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      if (held_[at(nodes[n])]) continue;
      if (n < 4 || space == PressureSpace::p2) return true;
      const auto& [from, to] = tetrahedron_edges[n - 4];
      if (b == from || b == to) return true;
    }
    return false;
  }

  // Stabilisation determines the differences between the pressures of a component, which is a set
  // of connected elements. The mean pressure of a component has an equation if one of its nodes is
  // free.
  void spread(const std::vector<std::int32_t>& moving) {
    std::vector<std::uint8_t> moves(determined_.size(), 0);
    for (const std::int32_t slot : moving) moves[at(pieces_.lowest(slot))] = 1;
    for (std::int32_t slot = 0; at(slot) < moves.size(); ++slot)
      if (moves[at(pieces_.lowest(slot))]) determined_[at(slot)] = 1;
  }

  const BodyModel& model_;
  const PressureSlots& slots_;
  const std::vector<std::uint8_t>& held_;
  std::vector<std::uint8_t> determined_;
  JoinedSets pieces_;
};

/// Returns the pressure slots of a node, ascending.
std::vector<std::int32_t> slotsAt(const PressureSlots& slots, std::int32_t node) {
  std::vector<std::int32_t> of_node;
  if (at(node) < slots.nodes()) of_node.push_back(node);
  for (const PressureSlots::Further& further : slots.furtherAt(node))
    of_node.push_back(slots.numberOf(further));
  return of_node;
}

}  // namespace

std::vector<std::int32_t> idlePressures(const BodyModel& model, const PressureSlots& slots,
                                        const std::vector<std::int32_t>& tool_nodes) {
  std::vector<std::uint8_t> held = fixedNodes(model);
  for (const std::int32_t node : tool_nodes) held[at(node)] = 1;
  const std::vector<std::uint8_t> determined = DeterminedPressures(model, slots, held).find(true);
  std::vector<std::int32_t> idle;
  for (const std::int32_t node : tool_nodes)
    for (const std::int32_t slot : slotsAt(slots, node))
      if (!determined[at(slot)]) idle.push_back(slot);
  std::ranges::sort(idle);
  return idle;
}

// Numbers the unknowns node by node, which keeps the unknowns of an element close together in the
// matrix.
DofMap::DofMap(const BodyModel& model, const PressureSlots& slots)
    : displacement_(3 * model.mesh.nodes.size(), -1), pressure_(slots.count(), -1) {
  const std::vector<std::uint8_t> fixed = fixedNodes(model),
                                  determined = DeterminedPressures(model, slots, fixed).find(false);
  for (std::int32_t node = 0; palpate::at(node) < model.mesh.nodes.size(); ++node) {
    for (std::size_t k = 3 * palpate::at(node); k < 3 * palpate::at(node) + 3; ++k)
      if (!model.fixed[k]) displacement_[k] = count_++;
    for (const std::int32_t slot : slotsAt(slots, node)) {
      if (!determined[palpate::at(slot)]) continue;
      pressure_[palpate::at(slot)] = count_++;
      ++pressures_;
    }
  }
}

std::vector<std::int32_t> DofMap::atNode(const PressureSlots& slots, std::int32_t node) const {
  std::vector<std::int32_t> of_node;
  for (int i = 0; i < 3; ++i) of_node.push_back(at({node, i}));
  for (const std::int32_t slot : slotsAt(slots, node))
    of_node.push_back(at({slot, pressure_component}));
  std::erase(of_node, -1);
  return of_node;
}

}  // namespace palpate
