#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

namespace palpate {

/// Point locator on a uniform grid, built in linear time. Immutable, so any thread may use it.
class NearPoints {
 public:
  NearPoints() = default;
  /// reach > 0, metres. At least one point is required.
  NearPoints(std::vector<Eigen::Vector3d> points, double reach);

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  double reach() const { return reach_; }  ///< m
  /// Returns every point within the reach of s and a few farther ones, ascending. Real time.
  std::span<const std::int32_t> near(const Eigen::Vector3d& s) const noexcept;
  /// Returns whether a point lies within the reach of s (<=). Real time.
  bool isReached(const Eigen::Vector3d& s) const noexcept;

 private:
  template <class Visit>
  void forEachCubeAround(const Eigen::Vector3d& point, Visit visit) const;

  std::vector<Eigen::Vector3d> points_;
  double reach_ = 0, edge_ = 0;  ///< m; edge_ is that of the cubes
  Eigen::Vector3d lowest_ = Eigen::Vector3d::Zero();
  std::array<std::int32_t, 3> cubes_ = {0, 0, 0};  ///< number along each axis
  std::vector<std::int32_t> first_, listed_;       ///< per cube, x fastest
};

/// Chooses places by farthest-point sampling. The relative distance of a place is its distance to
/// the nearest taken place divided by its value in `distances`. The first place is taken first,
/// then always the one with the largest relative distance, until none exceeds 1. Returns the taken
/// places in this order, the same on every machine. Metres, straight lines; `distances` holds one
/// value > 0 per place.
///
/// `accepts` is called before a place is taken. Refused places are left out and need no taken place
/// near them. It may throw, for instance if too many are taken.
std::vector<Eigen::Vector3d> farthestPoints(
    const std::vector<Eigen::Vector3d>& places, const std::vector<double>& distances,
    const std::function<bool(const Eigen::Vector3d& place, std::size_t taken)>& accepts);

}  // namespace palpate
