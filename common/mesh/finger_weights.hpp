#pragma once

#include "common/mesh/bump_integrals.hpp"

namespace palpate {

/// The weights by which a soft finger prescribes a mean displacement. The mean is over the surface
/// around its centre s, weighted by the bump (1 - (r/radius)^2)^2. In nodal displacements it is sum
/// of w_n(s) u_n, with w_n proportional to bumpIntegrals and of sum 1.
///
/// s may be any position at or near the surface. The weights are continuously differentiable in s,
/// across edges and corners of the surface too, because they depend on the distance r only.
struct FingerWeights {
  std::vector<std::int32_t> nodes;  ///< all nodes that the bump reaches, without fixed ones; sorted
  std::vector<double> weights;      ///< per node; with P2 displacement some may be negative
  std::vector<Eigen::Vector3d> gradients;   ///< d weight / d s, 1/m, per node; sum 0
  std::vector<Eigen::Matrix3d> curvatures;  ///< d2 weight / d s2, 1/m^2, per node; sum 0
  /// Share of the bump's integral on nodes that are not fixed, 0 to 1. It is 0 beyond the body too.
  double free_share = 0;
};

/// Computes the weights of a finger about `center` with this radius, metres; `fixed` is sorted. If
/// no free node is in reach, there are no weights and free_share is 0.
FingerWeights fingerWeights(const Mesh& mesh, const NodeSet& fixed, const Eigen::Vector3d& center,
                            double radius);

}  // namespace palpate
