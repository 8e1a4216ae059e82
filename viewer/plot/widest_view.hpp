#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate {

/// The direction, of length one, from which points look widest: along the axis in which they spread
/// least. Of its two senses the one that comes rather from -y, the front.
Eigen::Vector3d widestView(const std::vector<Eigen::Vector3d>& points);

}  // namespace palpate
