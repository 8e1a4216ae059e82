#include "viewer/report/compared_lattice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "viewer/report/thinned_space.hpp"

namespace palpate {
namespace {

/// Radius / spacing below which a thinned lattice says nothing; only every 2nd point may have less.
constexpr double smallest_ratio = 1.5;
constexpr double same_spacing = 1e-3;  ///< relative

std::string labelOf(const Dataset& dataset, std::int32_t factor) {
  static constexpr std::array<const char*, 5> parts = {"", ", not refined", ", every 2nd point",
                                                       ", every 3rd point", ", every 4th point"};
  return dataset.file().filename().string() + parts.at(static_cast<std::size_t>(factor));
}

bool hasUniform(const std::vector<ComparedLattice>& lattices, const std::vector<Dataset>& datasets,
                double spacing) {
  return std::any_of(lattices.begin(), lattices.end(), [&](const ComparedLattice& lattice) {
    const bool is_refined =
        lattice.factor == 0 && datasets[lattice.dataset].scene().accuracy.adaptive();
    return !is_refined && std::abs(lattice.spacing - spacing) <= same_spacing * spacing;
  });
}

}  // namespace

std::vector<ComparedLattice> latticesIn(const std::vector<Dataset>& datasets) {
  std::vector<ComparedLattice> lattices;
  for (std::size_t d = 0; d < datasets.size(); ++d)
    lattices.push_back(
        {d, 0, labelOf(datasets[d], 0), datasets[d].spaces().front().lattice.spacing()});
  for (std::size_t d = 0; d < datasets.size(); ++d) {
    const Lattice& dense = datasets[d].spaces().front().lattice;
    for (std::int32_t factor = datasets[d].scene().accuracy.adaptive() ? 1 : 2; factor <= 4;
         ++factor) {
      const double spacing = factor * dense.spacing();
      const bool is_coarse = factor > 2 && dense.radius() < smallest_ratio * spacing;
      if (!is_coarse && isThinnable(dense, factor) && !hasUniform(lattices, datasets, spacing))
        lattices.push_back({d, factor, labelOf(datasets[d], factor), spacing});
    }
  }
  return lattices;
}

std::shared_ptr<const SpaceTable> tableOf(const std::vector<Dataset>& datasets,
                                          const ComparedLattice& lattice, std::size_t space) {
  const SpaceTable& whole = datasets[lattice.dataset].spaces()[space];
  if (lattice.factor > 0) return std::make_shared<SpaceTable>(thinned(whole, lattice.factor));
  return {std::shared_ptr<const SpaceTable>(), &whole};  // owns nothing
}

}  // namespace palpate
