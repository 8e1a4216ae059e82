#pragma once

#include "common/mesh/mesh.hpp"

namespace palpate {

/// True when the nodes, at least one, lie on one line: held there a body can turn around it.
bool areCollinear(const NodeSet& nodes, const Mesh& mesh);

}  // namespace palpate
