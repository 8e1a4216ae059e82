#pragma once

#include <cstdint>
#include <vector>

#include "worker/solver/body_model.hpp"

namespace palpate {

/// Where an equation is: at a node, for a component of its displacement (0, 1, 2) or its pressure.
struct Place {
  std::int32_t node;
  int component;
};
inline constexpr int pressure_component = 3;

/// The numbers of the unknowns of a body: the displacements that are not fixed and the pressures of
/// the nodes that touch a material with a pressure, node by node. Dirichlet values have none, what
/// a rigid tool holds has (System).
class Unknowns {
 public:
  explicit Unknowns(const BodyModel& model);

  std::int32_t count() const { return count_; }
  std::int32_t pressures() const { return pressures_; }  ///< unknowns among them
  /// -1 where there is none.
  std::int32_t at(const Place& place) const {
    return number_[4 * static_cast<std::size_t>(place.node) + place.component];
  }

 private:
  std::int32_t count_ = 0, pressures_ = 0;
  std::vector<std::int32_t> number_;  ///< nNodes x 4
};

/// The nodes whose pressure says nothing while a rigid tool holds these nodes (sorted): all
/// elements around move with it as a whole, so that no volume can change, and neither a
/// stabilisation nor a bulk modulus gives the pressure a row of its own. Ascending.
std::vector<std::int32_t> idlePressures(const BodyModel& model,
                                        const std::vector<std::int32_t>& tool_nodes);

}  // namespace palpate
