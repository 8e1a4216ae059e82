#pragma once

#include "viewer/fields/cell_data.hpp"
#include "viewer/fields/direction_weights.hpp"
#include "viewer/fields/force_field.hpp"

namespace palpate {

/// Where the answers end along one direction, and how that changes when the direction turns.
struct RegionEdge {
  double radius = 0;     ///< m from rest
  double stiffness = 0;  ///< N/m of the continuation beyond it
  /// By the direction, tangential: m and N/m.
  Eigen::Vector3d radius_slope = Eigen::Vector3d::Zero(), stiffness_slope = Eigen::Vector3d::Zero();

  /// Adds `weight` times another edge.
  void add(double weight, const RegionEdge& other) noexcept;
};

/// The displacements that one configuration space answers: star-shaped around rest. It ends at the
/// workspace ball, or earlier where half of the answer would be extrapolated for longer than 1.25
/// spacings (points that failed, that were not reached, or whose element is being crushed); shorter
/// gaps are bridged. The edge is twice continuously differentiable by direction.
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

/// Whether a displacement of `length`, m, is in the region; on the edge, within round-off, it is.
inline bool isWithin(double length, double radius) noexcept {
  return length <= radius * (1 + 5e-10);
}

/// The answer beyond the edge: a continuation that only stiffens. With direction n, length r and
/// depth t = r - radius beyond the edge point q = radius n,
///
///   E(p) = E(q) - t n . F(q) + stiffness t^2 / 2
///
/// is one energy with the answers inside: the force is its exact gradient, continuous at the edge,
/// and along n it grows by the continuation's stiffness, which is at least that of the tissue
/// there, and large enough to bring max_force within 3 mm, or a tenth of the workspace's radius if
/// that is less. The stiffness is exact at the edge; beyond it, it leaves out how the tissue's
/// stiffness and the slope of the edge change along the edge. The bound grows by what the
/// continuation adds to the force. Real time.
///
/// at_edge: the answer at q; unit: n; depth: t, m, >= 0.
ForceSample continuedBeyond(const ForceSample& at_edge, const RegionEdge& edge,
                            const Eigen::Vector3d& unit, double depth) noexcept;

/// Displacements longer than this many radii of the ball are answered as if they were so long, so
/// that all numbers stay finite.
inline constexpr double farthest_in_radii = 4;

/// How every field answers a displacement, m: not at all where it is no number, by inRegion(p) in
/// the region, and beyond it by beyond(edge, unit, depth), which continues from the edge.
///
/// radius: of the ball; least_radius: every displacement up to it is in the region;
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
