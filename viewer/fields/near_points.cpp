#include "viewer/fields/near_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

constexpr double most_cubes = 48;  ///< along an axis

}  // namespace

NearPoints::NearPoints(std::vector<Eigen::Vector3d> points, double reach)
    : points_(std::move(points)), reach_(reach) {
  PALPATE_ASSERT(!points_.empty() && reach > 0, "a grid is made around something");
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points_) box.extend(point);
  lowest_ = box.min().array() - reach;
  const Eigen::Vector3d size = box.sizes().array() + 2 * reach;
  // Points far apart against their reach make longer lists, not more cubes than fit.
  edge_ = std::max(reach, size.maxCoeff() / most_cubes);
  for (std::size_t axis = 0; axis < 3; ++axis)
    cubes_[axis] = 1 + static_cast<std::int32_t>(size[static_cast<Eigen::Index>(axis)] / edge_);
  for (std::int32_t z = 0; z < cubes_[2]; ++z)
    for (std::int32_t y = 0; y < cubes_[1]; ++y)
      for (std::int32_t x = 0; x < cubes_[0]; ++x) {
        first_.push_back(static_cast<std::int32_t>(listed_.size()));
        const Eigen::Vector3d low = lowest_ + edge_ * Eigen::Vector3d(x, y, z);
        const Eigen::AlignedBox3d cube(low, low.array() + edge_);
        for (std::size_t n = 0; n < points_.size(); ++n)
          if (cube.exteriorDistance(points_[n]) <= reach)
            listed_.push_back(static_cast<std::int32_t>(n));
      }
  first_.push_back(static_cast<std::int32_t>(listed_.size()));
}

std::span<const std::int32_t> NearPoints::near(const Eigen::Vector3d& s) const noexcept {
  std::size_t cube = 0, stride = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<Eigen::Index>(axis);
    const double place = std::floor((s[a] - lowest_[a]) / edge_);
    if (!(place >= 0 && place < cubes_[axis])) return {};
    cube += stride * static_cast<std::size_t>(place);
    stride *= at(cubes_[axis]);
  }
  return std::span(listed_).subspan(at(first_[cube]), at(first_[cube + 1] - first_[cube]));
}

}  // namespace palpate
