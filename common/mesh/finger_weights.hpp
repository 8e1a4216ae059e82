#pragma once

#include "common/mesh/bump_integrals.hpp"

namespace palpate {

/// What a soft finger prescribes: the mean, over the surface around its centre s, of the
/// displacement, weighted by the bump (1 - (r/radius)^2)^2. In nodal displacements that is
/// sum of w_n(s) u_n, w_n proportional to bumpIntegrals and of sum 1.
///
/// s is any position at or near the surface. The weights are continuously differentiable in it,
/// over edges and corners of the surface too, because only the distance r counts.
struct FingerWeights {
  std::vector<std::int32_t> nodes;  ///< sorted: all that the bump reaches, fixed ones excepted
  std::vector<double> weights;      ///< per node; with P2 displacement some may be negative
  std::vector<Eigen::Vector3d> gradients;   ///< d weight / d s, 1/m, per node; sum 0
  std::vector<Eigen::Matrix3d> curvatures;  ///< d2 weight / d s2, 1/m^2, per node; sum 0
  /// Of the bump's integral: what lies on nodes that are not fixed, 0 to 1; 0 beyond the body too.
  double free_share = 0;
};

/// Of a finger about `center` with this radius, metres, `fixed` sorted. Without any free node in
/// reach there are no weights, and free_share is 0.
FingerWeights fingerWeights(const Mesh& mesh, const NodeSet& fixed, const Eigen::Vector3d& center,
                            double radius);

}  // namespace palpate
