#include "viewer/fields/answered_region.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Least total interpolation weight of solved points. The region ends where the weight is smaller,
/// unless the gap is short.
constexpr double least_support = 0.5;
/// Longest gap that is bridged, spacings. One failed point among solved points makes a gap of one
/// spacing.
constexpr double longest_gap = 1.25;
/// Step of the search along a direction, as a share of the smallest leaf's edge.
constexpr double step_share = 0.25;
/// Least radius of the region, as a share of the spacing.
constexpr double least_radius_share = 0.1;
/// The continuation reaches max_force within this depth: the smaller of a length, m, and a share of
/// the ball's radius.
constexpr double wall_depth = 3e-3, wall_depth_share = 0.1;
/// Factor on the largest tissue stiffness of the neighbouring table directions. The table is
/// coarse, so the stiffness between its directions may be larger.
constexpr double stiffness_margin = 1.1;

/// Computes the radius of a region and the stiffness of the tissue along straight lines from rest.
class Ways {
 public:
  explicit Ways(const CellData& data) : tree_(data.tree) {
    PALPATE_ASSERT(data.equilibria.size() == tree_.slots().size(), "each corner needs a solution");
    for (std::size_t s = 0; s < tree_.slots().size(); ++s) {
      const bool is_solved = tree_.slots()[s].kind == SlotKind::solved;
      const double length = tree_.displacement(static_cast<std::int32_t>(s)).norm();
      // Corners beyond the ball are usually extrapolated, so unsolved corners there are ignored.
      support_.emplace_back(is_solved, is_solved || isWithin(length, tree_.radius()));
      stiffness_.push_back(data.equilibria[s].stiffness);
    }
    fillHangingTrilinearly(tree_, support_);
    fillHangingTrilinearly(tree_, stiffness_);
    smallest_leaf_ = tree_.spacing();
    for (std::int32_t leaf = 0; leaf < std::ssize(tree_.leaves()); ++leaf)
      smallest_leaf_ = std::min(smallest_leaf_, tree_.edge(leaf));
  }

  double radiusAlong(const Eigen::Vector3d& unit) const {
    const double step = step_share * smallest_leaf_, gap = longest_gap * tree_.spacing();
    double radius = least_radius_share * tree_.spacing();
    for (double r = radius; r - radius <= gap; r += step) {
      const bool is_last = r >= tree_.radius();
      const LeafPlace place = tree_.find(std::min(r, tree_.radius()) * unit);
      if (place.leaf >= 0 && isSupported(place)) radius = std::min(r, tree_.radius());
      if (is_last) break;
    }
    return radius;
  }

  /// Returns the stiffness of the tissue along `unit`, N/m, at the displacement length * unit in
  /// the ball.
  double stiffnessAlong(const Eigen::Vector3d& unit, double length) const {
    const LeafPlace place = tree_.find(length * unit);
    if (place.leaf < 0) return 0;
    return -unit.dot(trilinear(tree_.corners(place.leaf), place.local, stiffness_) * unit);
  }

 private:
  bool isSupported(const LeafPlace& place) const {
    const Eigen::Vector2d shares = trilinear(tree_.corners(place.leaf), place.local, support_);
    return shares[0] >= least_support * shares[1];
  }

  const CellTree& tree_;
  double smallest_leaf_;
  std::vector<Eigen::Vector2d> support_;    ///< per slot: whether it is solved, whether it is
                                            ///< considered; 0 to 1 at hanging slots
  std::vector<Eigen::Matrix3d> stiffness_;  ///< per slot
};

}  // namespace

void RegionEdge::add(double weight, const RegionEdge& other) noexcept {
  radius += weight * other.radius;
  stiffness += weight * other.stiffness;
  radius_slope += weight * other.radius_slope;
  stiffness_slope += weight * other.stiffness_slope;
}

AnsweredRegion::AnsweredRegion(const CellData& data) {
  const Ways ways(data);
  std::vector<double> stiffness;
  for (const Eigen::Vector3d& unit : tableDirections()) {
    edges_.push_back({ways.radiusAlong(unit)});
    stiffness.push_back(ways.stiffnessAlong(unit, edges_.back().radius));
  }
  least_radius_ = data.tree.radius();
  for (const Edge& edge : edges_) least_radius_ = std::min(least_radius_, edge.radius);
  const double least = data.max_force / std::min(wall_depth, wall_depth_share * data.tree.radius());
  for (std::size_t n = 0; n < edges_.size(); ++n) {
    double largest = 0;
    for (const std::size_t beside : directionsBeside(n))
      largest = std::max(largest, stiffness[beside]);
    edges_[n].stiffness = std::max(least, stiffness_margin * largest);
  }
}

RegionEdge AnsweredRegion::along(const DirectionWeights& direction) const noexcept {
  RegionEdge edge;
  for (std::size_t n = 0; n < direction.size; ++n) {
    const Edge& tabulated = edges_[direction.numbers[n]];
    edge.radius += direction.weights[n] * tabulated.radius;
    edge.stiffness += direction.weights[n] * tabulated.stiffness;
    edge.radius_slope += tabulated.radius * direction.gradients[n];
    edge.stiffness_slope += tabulated.stiffness * direction.gradients[n];
  }
  return edge;
}

ForceSample continuedBeyond(const ForceSample& at_edge, const RegionEdge& edge,
                            const Eigen::Vector3d& unit, double depth) noexcept {
  const auto tangential = [&unit](const Eigen::Vector3d& v) -> Eigen::Vector3d {
    return v - unit.dot(v) * unit;
  };
  // Hessian of the energy at the edge, its products with `unit`, and the force that the
  // continuation adds along `unit`.
  const double radius = edge.radius, length = radius + depth, share = radius / length;
  const Eigen::Matrix3d hessian = -0.5 * (at_edge.stiffness + at_edge.stiffness.transpose());
  const Eigen::Vector3d along = hessian * unit, sideways = tangential(along);
  const double curvature = unit.dot(along), added = edge.stiffness * depth;

  ForceSample sample = at_edge;
  sample.inside = false;
  sample.beyond = depth;
  sample.energy += depth * (0.5 * added - unit.dot(at_edge.force));
  sample.force -= added * unit + share * depth * sideways +
                  (depth * (curvature - edge.stiffness) * edge.radius_slope +
                   0.5 * depth * depth * edge.stiffness_slope) /
                      length;
  sample.error_bound += (sample.force - at_edge.force).norm();

  // If the edge is oblique, the wall is steepest across the edge, not along `unit`.
  const Eigen::Vector3d steepest = unit - edge.radius_slope / length;
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - unit * unit.transpose();
  sample.stiffness = -edge.stiffness * steepest * steepest.transpose() +
                     curvature * (steepest * steepest.transpose() - unit * unit.transpose()) -
                     (added - share * depth * curvature) / length * across -
                     share * (1 + depth / length) * across * hessian * across -
                     share * share * (unit * sideways.transpose() + sideways * unit.transpose());
  return sample;
}

}  // namespace palpate
