#include "viewer/report/error_shells.hpp"

#include <algorithm>

namespace palpate {

std::vector<ErrorShell> measureShells(const std::vector<std::vector<DistanceComparison>>& methods,
                                      double radius, const AccuracyTarget& target) {
  std::vector<ErrorShell> shells;
  const auto edge = [&](std::size_t s) { return radius * static_cast<double>(s) / shell_count; };
  for (std::size_t s = 0; s < shell_count; ++s) shells.push_back({edge(s), edge(s + 1), {}});
  for (const std::vector<DistanceComparison>& method : methods) {
    std::vector<std::vector<ForceComparison>> in_shell(shell_count);
    for (const DistanceComparison& at : method) {
      // A point on the sphere, or outside of it by rounding, belongs to the last shell.
      const auto shell = static_cast<std::size_t>(shell_count * at.distance / radius);
      in_shell[std::min(shell, shell_count - 1)].push_back(at.forces);
    }
    for (std::size_t s = 0; s < shell_count; ++s)
      shells[s].methods.push_back(measureErrors(in_shell[s], target));
  }
  return shells;
}

}  // namespace palpate
