#include "worker/solver/unknowns.hpp"

#include <algorithm>

#include "worker/elements/element_kernels.hpp"
#include "worker/solver/element_geometry.hpp"

namespace palpate {
namespace {

bool isFixed(const BodyModel& model, const std::vector<std::int32_t>& nodes) {
  return std::all_of(nodes.begin(), nodes.end(), [&](std::int32_t node) {
    const std::uint8_t* fixed = &model.fixed[3 * static_cast<std::size_t>(node)];
    return fixed[0] && fixed[1] && fixed[2];
  });
}

/// 1 at the nodes whose pressure has an equation.
std::vector<std::uint8_t> nodesWithPressure(const BodyModel& model) {
  std::vector<std::uint8_t> with_pressure(model.mesh.nodes.size(), 0);
  for (std::size_t element = 0; element < model.mesh.tetrahedra.size(); ++element) {
    const std::vector<std::int32_t> nodes = nodesOf(model.mesh, element);
    const PressureSpace pressure = pressureSpaceOf(model, model.region_of[element]);
    // Where nothing can move the constraint says nothing; only a stabilisation would give the
    // pressure a row.
    if (pressure != PressureSpace::p1_stabilized && isFixed(model, nodes)) continue;
    for (int b = 0; b < pressureNodes(pressure); ++b) with_pressure[nodes[b]] = 1;
  }
  return with_pressure;
}

/// Whether the pressure of an element stands in no term but that of its volume.
bool isMultiplier(const BodyModel& model, std::size_t element) {
  const std::uint16_t region = model.region_of[element];
  return pressureSpaceOf(model, region) != PressureSpace::p1_stabilized &&
         isIncompressible(model.materials[region]);
}

}  // namespace

std::vector<std::int32_t> idlePressures(const BodyModel& model,
                                        const std::vector<std::int32_t>& tool_nodes) {
  std::vector<std::uint8_t> inside(model.mesh.nodes.size(), 0), speaks = inside;
  for (const std::int32_t node : tool_nodes) inside[node] = 1;
  for (std::size_t element = 0; element < model.mesh.tetrahedra.size(); ++element) {
    const int pressures = pressureNodes(pressureSpaceOf(model, model.region_of[element]));
    if (pressures == 0) continue;
    const std::vector<std::int32_t> nodes = nodesOf(model.mesh, element);
    const bool rigid = std::ranges::all_of(nodes, [&](std::int32_t node) { return inside[node]; });
    if (rigid && isMultiplier(model, element)) continue;
    for (int b = 0; b < pressures; ++b) speaks[nodes[b]] = 1;
  }
  std::vector<std::int32_t> idle;
  for (const std::int32_t node : tool_nodes)
    if (!speaks[node]) idle.push_back(node);
  return idle;
}

// Node by node, so that the unknowns of an element stand near each other in the matrix.
Unknowns::Unknowns(const BodyModel& model) : number_(4 * model.mesh.nodes.size(), -1) {
  const std::vector<std::uint8_t> with_pressure = nodesWithPressure(model);
  for (std::size_t node = 0; node < model.mesh.nodes.size(); ++node) {
    for (int i = 0; i < 3; ++i)
      if (!model.fixed[3 * node + i]) number_[4 * node + i] = count_++;
    if (with_pressure[node]) {
      number_[4 * node + pressure_component] = count_++;
      ++pressures_;
    }
  }
}

}  // namespace palpate
