#include "viewer/report/compared_lattice.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/interpolation/branch_check.hpp"

namespace palpate {
namespace {

/// A thinned lattice with a smaller ratio of radius to spacing has too few points and is left out.
/// The lattice of every 2nd point is used whatever its ratio.
constexpr double smallest_ratio = 1.5;
constexpr double same_spacing = 1e-3;  ///< relative difference up to which two spacings are the
                                       ///< same

std::string labelOf(const Dataset& dataset, std::int32_t factor) {
  static constexpr std::array<const char*, 5> parts = {"", ", not refined", ", every 2nd point",
                                                       ", every 3rd point", ", every 4th point"};
  return dataset.file().filename().string() + parts.at(factor);
}

bool hasUniform(const std::vector<ComparedLattice>& lattices, const std::vector<Dataset>& datasets,
                double spacing) {
  return std::ranges::any_of(lattices, [&](const ComparedLattice& lattice) {
    const bool is_refined =
        lattice.factor == 0 && datasets[lattice.dataset].scene().accuracy.adaptive();
    return !is_refined && std::abs(lattice.spacing - spacing) <= same_spacing * spacing;
  });
}

}  // namespace

bool isThinnable(const Lattice& lattice, std::int32_t factor) {
  return factor >= 1 && factor * lattice.spacing() <= lattice.radius() * (1 + 1e-12);
}

SpaceTable thinned(const SpaceTable& space, std::int32_t factor) {
  const Lattice& dense = space.lattice;
  if (!isThinnable(dense, factor))
    throw failure("{}: a lattice of {} times the spacing {} m does not fit a radius of {} m",
                  space.patch.name, factor, dense.spacing(), dense.radius());
  SpaceTable coarse;
  coarse.patch = space.patch;
  coarse.probes = space.probes;
  coarse.lattice = Lattice(dense.radius(), std::min(factor * dense.spacing(), dense.radius()));
  // Index of each dense point in the coarse lattice; -1 if it is dropped.
  std::vector<std::int32_t> number(space.points.size(), -1);
  const std::int32_t step = factor * dense.divisions();
  for (std::int32_t n = 0; n < coarse.lattice.size(); ++n) {
    LatticePoint point = coarse.lattice.point(n);
    for (std::int32_t& coordinate : point) coordinate *= step;
    const auto found = dense.indexOf(point);
    if (!found) {
      // If only a part of the ball was built (PushedPart), this point does not exist; nothing was
      // computed there.
      PointRecord& missing = coarse.points.emplace_back();
      missing.tag = Tag::failed;
      missing.cause = Cause::unreachable;
      continue;
    }
    number[*found] = n;
    coarse.points.push_back(space.points[*found]);
  }
  // If the parent was dropped, use the origin, where every chain of parents ends.
  for (PointRecord& point : coarse.points)
    if (point.parent >= 0) point.parent = std::max(number[point.parent], 0);
  for (FailedAttempt attempt : space.attempts) {
    attempt.target = number[attempt.target];
    attempt.parent = number[attempt.parent];
    if (attempt.target >= 0 && attempt.parent >= 0) coarse.attempts.push_back(attempt);
  }
  coarse.inconsistent_edges = inconsistentEdges(coarse);
  return coarse;
}

std::vector<ComparedLattice> latticesIn(const std::vector<Dataset>& datasets) {
  std::vector<ComparedLattice> lattices;
  const auto add = [&](std::size_t d, std::int32_t factor, double spacing) {
    lattices.push_back({d, factor, labelOf(datasets[d], factor), spacing});
  };
  for (std::size_t d = 0; d < datasets.size(); ++d)
    add(d, 0, datasets[d].spaces().front().lattice.spacing());
  // Whole datasets were added first. If one of them has the spacing of a thinned lattice, the
  // thinned one is left out.
  for (std::size_t d = 0; d < datasets.size(); ++d) {
    const Lattice& dense = datasets[d].spaces().front().lattice;
    const std::int32_t first = datasets[d].scene().accuracy.adaptive() ? 1 : 2;
    for (std::int32_t factor = first; factor <= 4; ++factor) {
      const double spacing = factor * dense.spacing();
      const bool is_coarse = factor > 2 && dense.radius() < smallest_ratio * spacing;
      if (!is_coarse && isThinnable(dense, factor) && !hasUniform(lattices, datasets, spacing))
        add(d, factor, spacing);
    }
  }
  return lattices;
}

std::shared_ptr<const SpaceTable> tableOf(const std::vector<Dataset>& datasets,
                                          const ComparedLattice& lattice, std::size_t space) {
  PALPATE_ASSERT(
      lattice.dataset < datasets.size() && space < datasets[lattice.dataset].spaces().size(),
      "the lattice must belong to one of these datasets");
  const SpaceTable& whole = datasets[lattice.dataset].spaces()[space];
  if (lattice.factor > 0) return std::make_shared<SpaceTable>(thinned(whole, lattice.factor));
  return {std::shared_ptr<const SpaceTable>(), &whole};  // no owner: the dataset keeps the table
}

}  // namespace palpate
