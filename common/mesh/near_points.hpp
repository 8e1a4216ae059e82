#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <span>
#include <vector>

namespace palpate {

/// Finds the points near a position. The points are listed per cube of a uniform grid, which is
/// built in linear time. Immutable, so any thread may use it.
class NearPoints {
 public:
  NearPoints() = default;
  /// `reach` is the search distance, metres, > 0. At least one point is required.
  NearPoints(std::vector<Eigen::Vector3d> points, double reach);

  const std::vector<Eigen::Vector3d>& points() const { return points_; }
  double reach() const { return reach_; }  ///< m
  /// Returns ascending point indices: all points within the reach of s, and possibly some farther
  /// ones. Real time.
  std::span<const std::int32_t> near(const Eigen::Vector3d& s) const noexcept;
  /// Returns whether a point lies within the reach of s (<=). Real time.
  bool isReached(const Eigen::Vector3d& s) const noexcept;

 private:
  template <class Visit>
  void forEachCubeAround(const Eigen::Vector3d& point, Visit visit) const;

  std::vector<Eigen::Vector3d> points_;
  double reach_ = 0, edge_ = 0;  ///< m; edge_ is the edge of a grid cube
  Eigen::Vector3d lowest_ = Eigen::Vector3d::Zero();
  std::array<std::int32_t, 3> cubes_ = {0, 0, 0};  ///< number of cubes along each axis
  /// The entries of cube n begin at listed_[first_[n]]; cubes are numbered with x fastest.
  std::vector<std::int32_t> first_, listed_;
};

/// Chooses some of `places` by farthest-point sampling, so that every place has a chosen one near
/// it. `distances` (positive) holds for each place the wanted distance to the nearest chosen place.
/// The first place is chosen first. Each next choice is the place whose distance to the nearest
/// chosen place, divided by its wanted distance, is largest. The choice ends when all these
/// quotients are at most 1. Distances are along straight lines, metres. Returns the places in order
/// of choice, the same on all machines.
///
/// `accepts` is called before a place is chosen, with the number of places `taken` so far. Places
/// that it refuses are never chosen and need no chosen place near them. `accepts` may throw, for
/// instance if too many places are chosen.
std::vector<Eigen::Vector3d> farthestPoints(
    const std::vector<Eigen::Vector3d>& places, const std::vector<double>& distances,
    const std::function<bool(const Eigen::Vector3d& place, std::size_t taken)>& accepts);

}  // namespace palpate
