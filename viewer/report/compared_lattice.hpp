#pragma once

#include "common/dataset/dataset.hpp"

namespace palpate {

/// Returns the space that a build with `factor` times the spacing would have found.
///
/// Keeps the points of the uniform lattice whose coordinates are multiples of `factor` spacings,
/// with their records, and all probes. Points that refinement added are dropped, so factor 1
/// returns the space before refinement. If the parent of a point is dropped, the origin becomes its
/// parent. Attempts whose target or parent is dropped are dropped too. Throws Error if factor < 1,
/// or if factor times the spacing is larger than the radius (isThinnable).
SpaceTable thinned(const SpaceTable& space, std::int32_t factor);

/// Returns whether a lattice with `factor` times the spacing would have any point besides the
/// origin.
bool isThinnable(const Lattice& lattice, std::int32_t factor);

/// A lattice on which methods are compared: all points of a dataset, or a coarser lattice made of
/// some of them.
struct ComparedLattice {
  std::size_t dataset = 0;  ///< index of the dataset
  std::int32_t factor = 0;  ///< 0: all points of the dataset; otherwise thinned by this factor
  std::string label;        ///< "liver.h5", "liver.h5, every 2nd point"
  double spacing = 0;       ///< m, before refinement
};

/// Returns the lattices that can be made of the datasets: all points of each dataset, the points
/// before refinement of each refined dataset, and every 2nd, 3rd and 4th point of each dataset.
/// Leaves out a thinned lattice if it has hardly any points, or if another uniform lattice has the
/// same spacing.
std::vector<ComparedLattice> latticesIn(const std::vector<Dataset>& datasets);

/// Returns the space of active node `space` on a lattice. `datasets` must outlive the result.
std::shared_ptr<const SpaceTable> tableOf(const std::vector<Dataset>& datasets,
                                          const ComparedLattice& lattice, std::size_t space);

}  // namespace palpate
