#pragma once

#include "viewer/fields/cell_data.hpp"
#include "viewer/fields/direction_weights.hpp"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// Edge of the answered region along one direction from rest: its radius, the stiffness of the
/// continuation beyond it, and the derivatives of both with respect to the direction.
struct RegionEdge {
  double radius = 0;     ///< distance of the edge from rest, m
  double stiffness = 0;  ///< stiffness of the continuation, N/m
  /// Derivatives with respect to the unit direction, tangential to the unit sphere, m and N/m.
  Eigen::Vector3d radius_slope = Eigen::Vector3d::Zero(), stiffness_slope = Eigen::Vector3d::Zero();

  void add(double weight, const RegionEdge& other) noexcept;
};

/// Region of the displacements at which a configuration space is interpolated, star-shaped around
/// rest. Along each direction it ends at the surface of the workspace ball, or before the first gap
/// longer than 1.25 spacings. In a gap, more than half of the interpolation weight belongs to
/// points without usable data, because they failed, were not reached, or have crushed elements.
/// Shorter gaps are bridged. The radius of the edge is a twice continuously differentiable function
/// of the direction.
///
/// Immutable: any thread may read.
class AnsweredRegion {
 public:
  AnsweredRegion() = default;
  explicit AnsweredRegion(const CellData& data);

  /// Returns a radius, m, within which every displacement is in the region.
  double leastRadius() const noexcept { return least_radius_; }
  /// Returns the edge of the region along a direction from rest. Real time.
  RegionEdge along(const DirectionWeights& direction) const noexcept;

 private:
  struct Edge {
    double radius = 0, stiffness = 0;
  };
  std::vector<Edge> edges_;  ///< one per tableDirections()
  double least_radius_ = 0;
};

/// Returns whether a displacement of `length`, m, is in a region that ends at `radius`, m. A
/// displacement on the edge is in the region, also if round-off puts it slightly outside.
inline bool isWithin(double length, double radius) noexcept {
  return length <= radius * (1 + 5e-10);
}

/// Extrapolates a sample beyond the edge of the region like a wall that only gets stiffer. With
/// direction n, length r and depth t = r - radius beyond the edge point q = radius n, the energy is
///
///   E(p) = E(q) - t n . F(q) + stiffness t^2 / 2
///
/// The force is the exact negative gradient of this energy, and continuous at the edge. Along n the
/// force grows with the stiffness of the continuation. This stiffness is at least that of the
/// tissue at the edge. It is also large enough that the force reaches max_force within 3 mm, or
/// within a tenth of the workspace's radius if that is less.
///
/// The stiffness of the sample is exact at the edge. Beyond the edge it neglects that the tissue's
/// stiffness and the slope of the edge change from direction to direction. The error bound grows by
/// the force that the continuation adds. Real time.
///
/// at_edge: the sample at q; unit: n; depth: t, m, >= 0.
ForceSample continuedBeyond(const ForceSample& at_edge, const RegionEdge& edge,
                            const Eigen::Vector3d& unit, double depth) noexcept;

/// Longest displacement that is evaluated, in radii of the ball. Longer ones are shortened to this
/// length, so that all numbers stay finite.
inline constexpr double farthest_in_radii = 4;

/// Evaluates a field at a displacement, m. Calls inRegion(p) if the displacement is in the answered
/// region, otherwise beyond(edge, unit, depth), which continues the field from the edge. A NaN
/// displacement gives a default sample.
///
/// radius: radius of the ball, m. least_radius: radius within which every displacement is in the
/// region, m. edgeAlong(unit): returns the RegionEdge along a unit direction. Real time.
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
