#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace palpate {

/// Some of these places, spread evenly: each is the one farthest from all before it, the first
/// place first, until none is farther than `distance` from one that was taken. In the order of
/// taking; the same on every machine. Metres, straight.
///
/// `accepts` is asked before a place is taken; those that it refuses are left out and need none
/// near. It may throw, also for a number taken so far that is too many.
std::vector<Eigen::Vector3d> farthestPoints(
    const std::vector<Eigen::Vector3d>& places, double distance,
    const std::function<bool(const Eigen::Vector3d& place, std::size_t taken)>& accepts);

}  // namespace palpate
