#include "viewer/report/held_out.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// Two displacements are the same if their distance is at most this fraction of a spacing.
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

/// Collects the solutions that solutionsOf(s) returns for each active node s.
template <class SolutionsOf>
HeldOut collected(HeldOutKind kind, std::size_t spaces, const SolutionsOf& solutionsOf) {
  HeldOut held_out;
  for (std::size_t s = 0; s < spaces; ++s)
    held_out.count += held_out.of_space.emplace_back(solutionsOf(s)).size();
  if (held_out.count > 0) held_out.kind = kind;
  return held_out;
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
      // The probes of the first table all differ, and comparing them would take quadratic time.
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

bool HeldOut::measures(const ComparedLattice& lattice) const {
  const bool is_source = source == lattice.dataset && lattice.factor == 0;
  return kind == HeldOutKind::probes || (kind == HeldOutKind::lattice_points && !is_source);
}

HeldOut heldOutOf(const std::vector<Dataset>& datasets,
                  const std::vector<ComparedLattice>& lattices) {
  const std::size_t spaces = datasets.front().spaces().size();
  for (const Dataset& dataset : datasets)
    PALPATE_ASSERT(dataset.spaces().size() == spaces, "datasets must have the same active nodes");
  HeldOut probes = collected(HeldOutKind::probes, spaces, [&](std::size_t s) {
    std::vector<const SpaceTable*> tables;
    for (const Dataset& dataset : datasets) tables.push_back(&dataset.spaces()[s]);
    return usableProbes(tables);
  });
  // If there is only one lattice, it uses all points, and none are left out.
  if (probes.count > 0 || lattices.size() < 2) return probes;
  const auto densest = std::ranges::max_element(
      datasets, {}, [](const Dataset& dataset) { return dataset.spaces().front().points.size(); });
  const std::size_t source = densest - datasets.begin();
  HeldOut points = collected(HeldOutKind::lattice_points, spaces, [&](std::size_t s) {
    std::vector<std::shared_ptr<const SpaceTable>> owners;
    std::vector<const SpaceTable*> tables;
    for (const ComparedLattice& lattice : lattices)
      if (lattice.dataset != source || lattice.factor != 0)
        tables.push_back(owners.emplace_back(tableOf(datasets, lattice, s)).get());
    return leftOutPoints(densest->spaces()[s], tables);
  });
  points.source = source;
  return points;
}

}  // namespace palpate
