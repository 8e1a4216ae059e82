#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace palpate {

/// Integer coordinates (i, j, k) of a lattice point; its displacement is spacing * (i, j, k).
using LatticePoint = std::array<std::int32_t, 3>;

/// i^2 + j^2 + k^2.
std::int64_t squaredNorm(const LatticePoint& point);

/// The lattice points of the closed workspace ball (paper, Eq. 11, with the origin).
///
/// Membership is decided in integers, i^2+j^2+k^2 <= (radius/spacing)^2: with r = 100 mm, spacing 20, 100/7,
/// 10, 100/15 mm these are 515, 1419, 4169, 14147 points, where a floating-point test drops some that lie
/// exactly on the sphere. "100/7 mm" may be written 14.3 mm: a spacing within 0.2 % of radius/n, n integer,
/// is taken as exactly radius/n.
///
/// Points are numbered 0..size()-1 by (squared norm, i, j, k); the origin is number 0. The numbering is part
/// of the dataset. Immutable after construction: any thread may read.
class Lattice {
 public:
  /// radius and spacing in metres, as check() demands them. 10 million points take about 0.2 GB and a second.
  Lattice(double radius, double spacing);

  /// Error (bad input) unless both are > 0, radius >= spacing, and the lattice has no more than 10 million
  /// points. Costs nothing.
  static void check(double radius, double spacing);

  double radius() const { return radius_; }    ///< metres
  double spacing() const { return spacing_; }  ///< metres, after the rounding above
  std::int32_t size() const { return static_cast<std::int32_t>(points_.size()); }
  const LatticePoint& point(std::int32_t index) const { return points_[index]; }
  /// Number of a lattice point; nothing when it is outside the ball.
  std::optional<std::int32_t> indexOf(const LatticePoint& point) const;
  /// Displacement of point `index`, metres.
  Eigen::Vector3d displacement(std::int32_t index) const;

  /// The up to 26 lattice points that differ by at most 1 in each coordinate, in the order in which they are
  /// tried as parents: shortest transition first, then nearest to the origin, then lexicographic (i, j, k).
  std::vector<std::int32_t> neighbours(std::int32_t index) const;

 private:
  double radius_;
  double spacing_;
  std::int32_t extent_;  ///< largest coordinate
  std::vector<LatticePoint> points_;
  std::vector<std::int32_t> index_of_;  ///< (2 extent + 1)^3 cube, -1 outside the ball
};

}  // namespace palpate
