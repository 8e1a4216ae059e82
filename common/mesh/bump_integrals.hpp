#pragma once

#include <Eigen/Core>

#include "common/mesh/mesh.hpp"

namespace palpate {

/// The integral over the surface, at rest, of each node's shape function times the bump
/// (1 - (r/radius)^2)^2, r the distance from `center`, zero for r > radius: m^2, one value per
/// node, zero for nodes that are not on the surface. Shape functions are linear, or quadratic on a
/// quadratic mesh: then single values may be negative. Their sum is the integral of the bump; the
/// relative error is below 1e-6 however coarse the mesh, because triangles are subdivided.
std::vector<double> bumpIntegrals(const Mesh& mesh, const Eigen::Vector3d& center, double radius);

}  // namespace palpate
