#include "viewer/report/held_out.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Displacements nearer than this part of a spacing are the same.
constexpr double same_place = 1e-6;

bool isLatticePoint(const Lattice& lattice, const Eigen::Vector3d& displacement) {
  LatticePoint point{};
  for (int axis = 0; axis < 3; ++axis)
    point[axis] = std::lround(displacement[axis] / lattice.unit());
  return lattice.indexOf(point).has_value() &&
         (lattice.displacementOf(point) - displacement).norm() <= same_place * lattice.spacing();
}

bool isPointOfAny(const std::vector<const SpaceTable*>& tables,
                  const Eigen::Vector3d& displacement) {
  return std::ranges::any_of(tables, [&](const SpaceTable* table) {
    return isLatticePoint(table->lattice, displacement);
  });
}

}  // namespace

std::string_view name(HeldOutKind kind) {
  return kind == HeldOutKind::probes           ? "probes"
         : kind == HeldOutKind::lattice_points ? "left-out lattice points"
                                               : "none";
}

std::vector<HeldOutSolution> usableProbes(const std::vector<const SpaceTable*>& tables) {
  std::vector<HeldOutSolution> solutions;
  for (const SpaceTable* table : tables)
    for (const auto& [displacement, record] : table->probes) {
      if (record.tag != Tag::expandable || isPointOfAny(tables, displacement)) continue;
      // Probes of one dataset differ; looking for them would take time with their square.
      const bool is_known = table != tables.front() &&
                            std::ranges::find(solutions, displacement,
                                              &HeldOutSolution::displacement) != solutions.end();
      if (!is_known) solutions.push_back({displacement, record.equilibrium.force});
    }
  return solutions;
}

std::vector<HeldOutSolution> leftOutPoints(const SpaceTable& dense,
                                           const std::vector<const SpaceTable*>& tables) {
  std::vector<HeldOutSolution> solutions;
  for (std::int32_t n = 0; n < dense.lattice.size(); ++n) {
    const PointRecord& point = dense.points[n];
    const Eigen::Vector3d displacement = dense.lattice.displacement(n);
    if (point.tag == Tag::expandable &&
        displacement.norm() <= dense.lattice.radius() * (1 + 1e-12) &&
        !isPointOfAny(tables, displacement))
      solutions.push_back({displacement, point.equilibrium.force});
  }
  return solutions;
}

}  // namespace palpate
