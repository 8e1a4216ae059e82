#pragma once

#include <limits>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// The smallest det F of a body, and the element in which it occurs.
struct SmallestDetF {
  double det_F = std::numeric_limits<double>::infinity();
  std::int32_t element = -1;  ///< index into Mesh::tetrahedra
};

/// Returns the smallest det F at the nodes of a quadratic mesh. On a linear mesh, where det F is
/// constant per element, returns no element (-1). This check is needed because kernels evaluate det
/// F only at quadrature points, and at nodes it can be smaller. `u`: nNodes x 3 displacements,
/// metres.
SmallestDetF smallestDetFAtNodes(const Mesh& mesh, const std::vector<double>& u);

}  // namespace palpate
