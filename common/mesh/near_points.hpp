#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

namespace palpate {

/// Which of some points in space lie near a position: lists per cube of a grid, made once, in a
/// time that goes with the number of points.
/// Immutable: any thread may ask.
class NearPoints {
 public:
  NearPoints() = default;
  /// reach > 0, metres; at least one point.
  NearPoints(std::vector<Eigen::Vector3d> points, double reach);

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  double reach() const { return reach_; }  ///< m
  /// Every point within the reach of s, and a few farther ones; ascending. Real time.
  std::span<const std::int32_t> near(const Eigen::Vector3d& s) const noexcept;
  /// Whether a point lies within the reach of s, or at its end. Real time.
  bool isReached(const Eigen::Vector3d& s) const noexcept;

 private:
  template <class Visit>
  void forEachCubeAround(const Eigen::Vector3d& point, Visit visit) const;

  std::vector<Eigen::Vector3d> points_;
  double reach_ = 0, edge_ = 0;  ///< m; edge_: of the cubes
  Eigen::Vector3d lowest_ = Eigen::Vector3d::Zero();
  std::array<std::int32_t, 3> cubes_ = {0, 0, 0};  ///< along the axes
  std::vector<std::int32_t> first_, listed_;       ///< per cube, x fastest
};

/// Some of these places: each is the one farthest from all before it, in its distance, the first
/// place first, until none is farther than its distance from one that was taken. In the order of
/// taking; the same on every machine. Metres, straight; `distances` > 0, one per place.
///
/// `accepts` is asked before a place is taken; those that it refuses are left out and need none
/// near. It may throw, also for a number taken so far that is too many.
std::vector<Eigen::Vector3d> farthestPoints(
    const std::vector<Eigen::Vector3d>& places, const std::vector<double>& distances,
    const std::function<bool(const Eigen::Vector3d& place, std::size_t taken)>& accepts);

}  // namespace palpate
