#pragma once

#include <span>
#include <vector>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// Returns det F for every tetrahedron, where F = I + grad u is the deformation gradient. On linear
/// meshes it is constant per tetrahedron. On quadratic meshes it is a polynomial of the third
/// degree, and the result is the smallest value at the places that the solver checks: the 15
/// quadrature points (Stroud T3:5-1) and the ten nodes. The smallest of all results is therefore
/// the configuration's min_det_F, up to the rounding of displacements to float32.
///
/// displacement: x, y, z of every node, metres.
std::vector<float> detFOf(const Mesh& mesh, std::span<const float> displacement);

}  // namespace palpate
