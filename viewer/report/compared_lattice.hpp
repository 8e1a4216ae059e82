#pragma once

#include "common/dataset/dataset.hpp"

namespace palpate {

/// Returns the space that a build with `factor` times the spacing would have found.
///
/// Keeps the uniform lattice points whose coordinates are multiples of `factor` spacings, with
/// their records and the probes. Refinement and splits are dropped, so factor 1 returns the space
/// before refinement. A dropped parent becomes the origin; attempts at or from dropped points are
/// dropped. Throws Error if factor < 1 or factor times the spacing exceeds the radius
/// (isThinnable).
SpaceTable thinned(const SpaceTable& space, std::int32_t factor);

/// Returns whether a lattice with `factor` times the spacing has more points than the origin.
bool isThinnable(const Lattice& lattice, std::int32_t factor);

/// A lattice on which methods are compared: a dataset as it is, or a coarser lattice in it.
struct ComparedLattice {
  std::size_t dataset = 0;  ///< index of the dataset
  std::int32_t factor = 0;  ///< 0: the dataset as it is; otherwise thinned by this factor
  std::string label;        ///< "liver.h5", "liver.h5, every 2nd point"
  double spacing = 0;       ///< m, before refinement
};

/// Returns the lattices in the datasets: each dataset as it is, refined ones also before
/// refinement, and every 2nd, 3rd and 4th point of each. Leaves out thinned lattices with hardly
/// any points, or with the spacing of another uniform lattice.
std::vector<ComparedLattice> latticesIn(const std::vector<Dataset>& datasets);

/// Returns the table of active node `space` on a lattice of `datasets`, which must outlive it.
std::shared_ptr<const SpaceTable> tableOf(const std::vector<Dataset>& datasets,
                                          const ComparedLattice& lattice, std::size_t space);

}  // namespace palpate
