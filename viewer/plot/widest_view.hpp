#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate {

/// Returns the unit direction from which points look widest: along the axis of their least spread,
/// with the sign that points toward -y, the front.
Eigen::Vector3d widestView(const std::vector<Eigen::Vector3d>& points);

}  // namespace palpate
