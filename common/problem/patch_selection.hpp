#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/scene/scene.hpp"
#include "common/space/active_patch.hpp"

namespace palpate {

/// The patch of an [[active]] table. A rigid one holds all nodes within the radius, inner ones and
/// mid-edge nodes too; a weighted one those of the surface, with their weights
/// (ActivePatch::weights). Fixed nodes are left out. Error (bad input), naming the active node,
/// when it does not exist or is not a vertex of the surface, when `near` is far from the body, or
/// when fewer than three nodes are left to be averaged.
ActivePatch selectPatch(const ActiveSelection& selection, const Mesh& mesh, const NodeSet& fixed);

}  // namespace palpate
