#include "common/base/farthest_points.hpp"

#include <algorithm>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {

std::vector<Eigen::Vector3d> farthestPoints(
    const std::vector<Eigen::Vector3d>& places, double distance,
    const std::function<bool(const Eigen::Vector3d& place, std::size_t taken)>& accepts) {
  PALPATE_ASSERT(distance > 0, "places are some way apart");
  std::vector<double> distances(places.size(), std::numeric_limits<double>::infinity());
  std::vector<Eigen::Vector3d> taken;
  while (!places.empty()) {
    const auto farthest = at(std::ranges::max_element(distances) - distances.begin());
    if (distances[farthest] <= distance) break;
    const Eigen::Vector3d& place = places[farthest];
    if (!accepts(place, taken.size())) {
      distances[farthest] = 0;
      continue;
    }
    taken.push_back(place);
    for (std::size_t n = 0; n < places.size(); ++n)
      distances[n] = std::min(distances[n], (places[n] - place).norm());
  }
  return taken;
}

}  // namespace palpate
