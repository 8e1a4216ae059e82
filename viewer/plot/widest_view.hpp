#pragma once

#include <Eigen/Core>
#include <vector>

namespace palpate {

/// Returns the unit direction from which a set of points looks widest: the direction in which the
/// points spread least. Its sign is chosen so that it points toward -y, the front.
Eigen::Vector3d widestView(const std::vector<Eigen::Vector3d>& points);

}  // namespace palpate
