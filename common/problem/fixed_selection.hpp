#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// The nodes that [fixed] selects: mid-edge nodes too, by their position, by their group, or
/// because both vertices of their edge are listed in `nodes`. Error (bad input), naming the key,
/// when a selector selects nothing or a group or node does not exist.
NodeSet selectFixed(const FixedSelection& selection, const Mesh& mesh);

}  // namespace palpate
