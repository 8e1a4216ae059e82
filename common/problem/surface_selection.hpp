#pragma once

#include <vector>

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// The [[active]] tables with every `surface` replaced by one table for each vertex of the surface
/// that it selects and that is not fixed, in the order of their numbers, called NAME-NODE; radius
/// and tool are those of the table. Error (bad input), naming table and key, when a selector holds
/// no vertex of the surface, when all that are selected are fixed, when a group does not exist, or
/// when two active nodes have one name then.
std::vector<ActiveSelection> expandSurfaces(const std::vector<ActiveSelection>& selections,
                                            const Mesh& mesh, const NodeSet& fixed);

}  // namespace palpate
