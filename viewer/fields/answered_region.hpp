#pragma once

#include "viewer/fields/cell_data.hpp"
#include "viewer/fields/direction_weights.hpp"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// Edge of the answered region along one direction, and its derivatives with respect to the
/// direction.
struct RegionEdge {
  double radius = 0;     ///< m from rest
  double stiffness = 0;  ///< N/m, of the continuation beyond the edge
  /// Derivatives by the direction, tangential: m and N/m.
  Eigen::Vector3d radius_slope = Eigen::Vector3d::Zero(), stiffness_slope = Eigen::Vector3d::Zero();

  /// Adds `weight` times another edge.
  void add(double weight, const RegionEdge& other) noexcept;
};

/// The displacements that a configuration space answers by interpolation: a region that is
/// star-shaped around rest. It ends at the workspace ball, or earlier where half of the
/// interpolation would be extrapolated over more than 1.25 spacings. Such gaps come from failed
/// points, points that were not reached, and crushed elements; shorter ones are bridged. The edge
/// is twice continuously differentiable in the direction.
///
/// Immutable: any thread may read.
class AnsweredRegion {
 public:
  AnsweredRegion() = default;
  explicit AnsweredRegion(const CellData& data);

  /// Every displacement up to this length, m, is in the region.
  double leastRadius() const noexcept { return least_radius_; }
  /// Real time.
  RegionEdge along(const DirectionWeights& direction) const noexcept;

 private:
  struct Edge {
    double radius = 0, stiffness = 0;
  };
  std::vector<Edge> edges_;  ///< per tableDirections()
  double least_radius_ = 0;
};

/// Whether a displacement of `length`, m, is in a region that ends at `radius`, m. A displacement
/// on the edge, within round-off, is.
inline bool isWithin(double length, double radius) noexcept {
  return length <= radius * (1 + 5e-10);
}

/// Continues a sample beyond the edge by a wall that only stiffens. With direction n, length r and
/// depth t = r - radius beyond the edge point q = radius n,
///
///   E(p) = E(q) - t n . F(q) + stiffness t^2 / 2
///
/// is one energy with the interpolation inside. The force is its exact gradient, and continuous at
/// the edge. Along n it grows by the stiffness of the continuation. This is at least the stiffness
/// of the tissue there. It is also large enough to reach max_force within 3 mm, or within a tenth
/// of the workspace's radius if that is less.
///
/// The stiffness is exact at the edge. Beyond it, the changes of the tissue's stiffness and of the
/// edge's slope along the edge are neglected. The error bound grows by the force that the
/// continuation adds. Real time.
///
/// at_edge: the sample at q; unit: n; depth: t, m, >= 0.
ForceSample continuedBeyond(const ForceSample& at_edge, const RegionEdge& edge,
                            const Eigen::Vector3d& unit, double depth) noexcept;

/// Longer displacements are shortened to this many radii of the ball, so that all numbers stay
/// finite.
inline constexpr double farthest_in_radii = 4;

/// Evaluates a field at a displacement, m: inRegion(p) in the region, and beyond(edge, unit,
/// depth), a continuation from the edge, outside it. A NaN gives a default sample.
///
/// radius: of the ball; least_radius: every displacement up to this length is in the region;
/// edgeAlong(unit): the RegionEdge. Real time.
template <class EdgeAlong, class InRegion, class Beyond>
auto answerTo(const Eigen::Vector3d& displacement, double radius, double least_radius,
              EdgeAlong edgeAlong, InRegion inRegion, Beyond beyond) noexcept
    -> decltype(inRegion(displacement)) {
  if (displacement.array().isNaN().any()) return {};
  const Eigen::Vector3d p = nearestInBall(displacement, farthest_in_radii * radius);
  const double length = p.norm();
  if (isWithin(length, least_radius)) return inRegion(p);
  const Eigen::Vector3d unit = p / length;
  const auto edge = edgeAlong(unit);
  if (isWithin(length, edge.radius)) return inRegion(p);
  return beyond(edge, unit, length - edge.radius);
}

}  // namespace palpate
