#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// det F of every tetrahedron, F = I + grad u the deformation gradient. On a linear mesh it is
/// constant in one; on a quadratic one, where it is a polynomial of the third degree, the smallest
/// of the places that the solver looks at: the 15 points of the quadrature (Stroud T3:5-1) and the
/// ten nodes. So the smallest of all is a configuration's min_det_F, but for what rounding the
/// displacements to float32 changes.
///
/// `displacement`: x y z of every node, metres.
std::vector<float> detFOf(const Mesh& mesh, std::span<const float> displacement);

}  // namespace palpate
