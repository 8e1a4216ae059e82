#include "common/base/farthest_points.hpp"

#include <algorithm>
#include <limits>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"

namespace palpate {

std::vector<Eigen::Vector3d> farthestPoints(
    const std::vector<Eigen::Vector3d>& places, const std::vector<double>& distances,
    const std::function<bool(const Eigen::Vector3d& place, std::size_t taken)>& accepts) {
  PALPATE_ASSERT(distances.size() == places.size(), "each place has a distance");
  std::vector<double> away(places.size(), std::numeric_limits<double>::infinity());
  std::vector<Eigen::Vector3d> taken;
  while (!places.empty()) {
    const auto farthest = at(std::ranges::max_element(away) - away.begin());
    if (away[farthest] <= 1) break;
    const Eigen::Vector3d& place = places[farthest];
    if (!accepts(place, taken.size())) {
      away[farthest] = 0;
      continue;
    }
    taken.push_back(place);
    for (std::size_t n = 0; n < places.size(); ++n)
      away[n] = std::min(away[n], (places[n] - place).norm() / distances[n]);
  }
  return taken;
}

}  // namespace palpate
