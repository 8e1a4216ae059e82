#include "common/mesh/coincident_nodes.hpp"

#include <algorithm>
#include <numeric>

#include "common/base/joined_sets.hpp"

namespace palpate {

std::vector<std::array<std::int32_t, 2>> coincidentNodes(const std::vector<Eigen::Vector3d>& nodes,
                                                         double near) {
  // Along a direction in which the nodes of a regular mesh lie apart.
  const Eigen::Vector3d along = Eigen::Vector3d(0.5129, 0.6427, 0.5691).normalized();
  std::vector<std::int32_t> order(nodes.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<double> position;
  for (const Eigen::Vector3d& node : nodes) position.push_back(along.dot(node));
  std::ranges::sort(order, {}, [&](std::int32_t n) { return position[n]; });
  JoinedSets places(nodes.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    for (std::size_t k = i + 1; k < order.size() && position[order[k]] - position[order[i]] <= near;
         ++k)
      if ((nodes[order[k]] - nodes[order[i]]).norm() <= near) places.join(order[i], order[k]);
  std::vector<std::array<std::int32_t, 2>> coincident;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes.size()); ++n)
    if (const std::int32_t lowest = places.lowest(n); lowest != n)
      coincident.push_back({n, lowest});
  return coincident;
}

}  // namespace palpate
