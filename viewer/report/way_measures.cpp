#include "viewer/report/way_measures.hpp"

#include <algorithm>

namespace palpate {

std::vector<WayShell> measureWays(const std::vector<std::vector<WayComparison>>& methods,
                                  double radius, const AccuracyTarget& target) {
  std::vector<WayShell> shells(way_shells);
  for (std::size_t s = 0; s < way_shells; ++s) {
    shells[s].from = radius * static_cast<double>(s) / way_shells;
    shells[s].to = radius * static_cast<double>(s + 1) / way_shells;
  }
  for (const std::vector<WayComparison>& method : methods) {
    std::vector<std::vector<ForceComparison>> in_shell(way_shells);
    for (const WayComparison& at : method) {
      // A point on the sphere, or outside of it by rounding, belongs to the last shell.
      const auto shell = static_cast<std::size_t>(way_shells * at.way / radius);
      in_shell[std::min(shell, way_shells - 1)].push_back(at.forces);
    }
    for (std::size_t s = 0; s < way_shells; ++s)
      shells[s].methods.push_back(measureErrors(in_shell[s], target));
  }
  return shells;
}

}  // namespace palpate
