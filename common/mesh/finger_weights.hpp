#pragma once

#include "common/mesh/bump_integrals.hpp"

namespace palpate {

/// Weights of the nodes under a soft finger. The finger prescribes the weighted mean of the nodal
/// displacements u_n, which is the sum over n of w_n(s) u_n. This is the mean displacement of the
/// surface around the finger's centre s, weighted by the bump (1 - (r/radius)^2)^2, with r the
/// distance from s. The weights are proportional to the bumpIntegrals and add up to 1.
///
/// s may be any position on or near the surface. The weights are continuously differentiable in s,
/// even across edges and corners of the surface, because they depend only on the distance r.
struct FingerWeights {
  std::vector<std::int32_t> nodes;  ///< all nodes that the bump reaches, except fixed ones; sorted
  std::vector<double> weights;      ///< per node; with P2 displacement some may be negative
  std::vector<Eigen::Vector3d> gradients;   ///< d weight / d s, 1/m, per node; sum 0
  std::vector<Eigen::Matrix3d> curvatures;  ///< d2 weight / d s2, 1/m^2, per node; sum 0
  /// Share of the bump's integral that belongs to nodes that are not fixed, 0 to 1. Also 0 if the
  /// bump does not reach the surface.
  double free_share = 0;
};

/// Computes the weights of a finger centred at `center` (metres) with this radius (metres); `fixed`
/// is sorted. If the bump reaches no free node, `nodes` is empty and free_share is 0. Without
/// `derivatives`, gradients and curvatures are zero.
FingerWeights fingerWeights(const Mesh& mesh, const NodeSet& fixed, const Eigen::Vector3d& center,
                            double radius, bool derivatives = true);

}  // namespace palpate
