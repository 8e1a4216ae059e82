#include "common/mesh/near_points.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

constexpr double most_cubes = 48;  ///< largest number of cubes along each axis

}  // namespace

NearPoints::NearPoints(std::vector<Eigen::Vector3d> points, double reach)
    : points_(std::move(points)), reach_(reach) {
  PALPATE_ASSERT(!points_.empty() && reach > 0, "a search grid needs points and a radius");
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& point : points_) box.extend(point);
  lowest_ = box.min().array() - reach;
  const Eigen::Vector3d size = box.sizes().array() + 2 * reach;
  // The number of cubes is limited. If the points extend over many times the reach, cubes are
  // larger and their lists longer.
  edge_ = std::max(reach, size.maxCoeff() / most_cubes);
  for (std::size_t axis = 0; axis < 3; ++axis)
    cubes_[axis] = 1 + static_cast<std::int32_t>(size[static_cast<Eigen::Index>(axis)] / edge_);
  // First count the entries per cube, then list them in the order of the points.
  std::vector<std::int32_t> counts(at(cubes_[0]) * at(cubes_[1]) * at(cubes_[2]), 0);
  for (const Eigen::Vector3d& point : points_)
    forEachCubeAround(point, [&](std::size_t cube) { ++counts[cube]; });
  first_.assign(counts.size() + 1, 0);
  std::partial_sum(counts.begin(), counts.end(), first_.begin() + 1);
  listed_.resize(at(first_.back()));
  std::vector<std::int32_t> next(first_.begin(), first_.end() - 1);
  for (std::size_t n = 0; n < points_.size(); ++n)
    forEachCubeAround(points_[n], [&](std::size_t cube) {
      listed_[at(next[cube]++)] = static_cast<std::int32_t>(n);
    });
}

/// Calls visit(index) for each cube with a place within the reach of the point.
template <class Visit>
void NearPoints::forEachCubeAround(const Eigen::Vector3d& point, Visit visit) const {
  const auto cubeOf = [&](double x, int axis) {
    return std::clamp(static_cast<std::int32_t>((x - lowest_[axis]) / edge_), 0,
                      cubes_[at(axis)] - 1);
  };
  std::array<std::int32_t, 3> low, high;
  for (int axis = 0; axis < 3; ++axis) {
    low[at(axis)] = cubeOf(point[axis] - reach_, axis);
    high[at(axis)] = cubeOf(point[axis] + reach_, axis);
  }
  for (std::int32_t z = low[2]; z <= high[2]; ++z)
    for (std::int32_t y = low[1]; y <= high[1]; ++y)
      for (std::int32_t x = low[0]; x <= high[0]; ++x) {
        const Eigen::Vector3d corner = lowest_ + edge_ * Eigen::Vector3d(x, y, z);
        const Eigen::AlignedBox3d cube(corner, corner.array() + edge_);
        if (cube.exteriorDistance(point) <= reach_)
          visit(at(x) + at(cubes_[0]) * (at(y) + at(cubes_[1]) * at(z)));
      }
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

bool NearPoints::isReached(const Eigen::Vector3d& s) const noexcept {
  return std::ranges::any_of(near(s),
                             [&](std::int32_t n) { return (points_[at(n)] - s).norm() <= reach_; });
}

std::vector<Eigen::Vector3d> farthestPoints(
    const std::vector<Eigen::Vector3d>& places, const std::vector<double>& distances,
    const std::function<bool(const Eigen::Vector3d& place, std::size_t taken)>& accepts) {
  PALPATE_ASSERT(distances.size() == places.size(), "each place must have a distance");
  /// A place without a chosen one near it. `squared` (m^2) and `quotient` are those of the distance
  /// to the nearest chosen place.
  struct Open {
    Eigen::Vector3d place;
    double distance;
    double squared = std::numeric_limits<double>::infinity(), quotient = squared;
  };
  const auto nearer = [](const Open& a, const Open& b) { return a.quotient < b.quotient; };
  std::vector<Open> open;
  for (std::size_t n = 0; n < places.size(); ++n) open.push_back({places[n], distances[n]});
  std::vector<Eigen::Vector3d> taken;
  while (!open.empty()) {
    const auto farthest = std::ranges::max_element(open, nearer);
    if (farthest->quotient <= 1) break;
    const Eigen::Vector3d place = farthest->place;
    if (!accepts(place, taken.size())) {
      farthest->squared = farthest->quotient = 0;
      continue;
    }
    taken.push_back(place);
    for (Open& other : open) {
      const double squared = (other.place - place).squaredNorm();
      if (squared >= other.squared) continue;
      other.squared = squared;
      other.quotient = std::sqrt(squared) / other.distance;
    }
    std::erase_if(open, [](const Open& other) { return other.quotient <= 1; });
  }
  return taken;
}

}  // namespace palpate
