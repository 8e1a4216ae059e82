#include "viewer/report/held_out.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {
namespace {

/// Displacements nearer than this part of a spacing are the same.
constexpr double same_place = 1e-6;

bool isLatticePoint(const Lattice& lattice, const Eigen::Vector3d& displacement) {
  LatticePoint point{};
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    point[static_cast<std::size_t>(axis)] =
        static_cast<std::int32_t>(std::lround(displacement[axis] / lattice.unit()));
  return lattice.indexOf(point).has_value() &&
         (lattice.displacementOf(point) - displacement).norm() <= same_place * lattice.spacing();
}

bool isPointOfAny(const std::vector<const SpaceTable*>& tables,
                  const Eigen::Vector3d& displacement) {
  return std::any_of(tables.begin(), tables.end(), [&](const SpaceTable* table) {
    return isLatticePoint(table->lattice, displacement);
  });
}

}  // namespace

std::string_view name(HeldOutKind kind) {
  switch (kind) {
    case HeldOutKind::probes:
      return "probes";
    case HeldOutKind::lattice_points:
      return "left-out lattice points";
    case HeldOutKind::none:
      break;
  }
  return "none";
}

std::vector<HeldOutSolution> usableProbes(const std::vector<const SpaceTable*>& tables) {
  std::vector<HeldOutSolution> solutions;
  for (const SpaceTable* table : tables)
    for (const Probe& probe : table->probes) {
      const auto same = [&](const HeldOutSolution& known) {
        return known.displacement == probe.displacement;
      };
      if (probe.record.tag != Tag::expandable || isPointOfAny(tables, probe.displacement) ||
          (table != tables.front() && std::any_of(solutions.begin(), solutions.end(), same)))
        continue;
      solutions.push_back({probe.displacement, probe.record.equilibrium.force});
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
