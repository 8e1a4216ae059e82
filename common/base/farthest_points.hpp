#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace palpate {

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
