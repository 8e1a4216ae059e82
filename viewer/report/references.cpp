#include "viewer/report/references.hpp"

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

std::string_view name(ReferenceKind kind) {
  switch (kind) {
    case ReferenceKind::probes:
      return "probes";
    case ReferenceKind::left_out:
      return "left-out lattice points";
    case ReferenceKind::none:
      break;
  }
  return "none";
}

std::vector<Reference> usableProbes(const std::vector<const SpaceTable*>& tables) {
  std::vector<Reference> references;
  for (const SpaceTable* table : tables)
    for (const Probe& probe : table->probes) {
      const auto same = [&](const Reference& known) {
        return known.displacement == probe.displacement;
      };
      if (probe.record.tag != Tag::expandable || isPointOfAny(tables, probe.displacement) ||
          (table != tables.front() && std::any_of(references.begin(), references.end(), same)))
        continue;
      references.push_back({probe.displacement, probe.record.equilibrium.force});
    }
  return references;
}

std::vector<Reference> leftOutPoints(const SpaceTable& dense,
                                     const std::vector<const SpaceTable*>& tables) {
  std::vector<Reference> references;
  for (std::int32_t n = 0; n < dense.lattice.size(); ++n) {
    const PointRecord& point = dense.points[n];
    const Eigen::Vector3d displacement = dense.lattice.displacement(n);
    if (point.tag == Tag::expandable &&
        displacement.norm() <= dense.lattice.radius() * (1 + 1e-12) &&
        !isPointOfAny(tables, displacement))
      references.push_back({displacement, point.equilibrium.force});
  }
  return references;
}

}  // namespace palpate
