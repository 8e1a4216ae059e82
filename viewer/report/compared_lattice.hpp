#pragma once

#include "common/dataset/dataset.hpp"

namespace palpate {

/// What a build with `factor` times the spacing would have found: the uniform lattice points whose
/// coordinates, in spacings, are multiples of `factor`, with their records. No refinement and no
/// splits, so that factor 1 is the space as it was before it was refined. Parents and attempts that
/// are gone become the origin, or are dropped; the probes stay. Error when factor < 1, or factor
/// times the spacing exceeds the radius (isThinnable).
SpaceTable thinned(const SpaceTable& space, std::int32_t factor);

/// A lattice with `factor` times the spacing has more than the origin.
bool isThinnable(const Lattice& lattice, std::int32_t factor);

/// A lattice that methods are compared on: a dataset as it is, or a coarser lattice in it.
struct ComparedLattice {
  std::size_t dataset = 0;  ///< which of the datasets
  std::int32_t factor = 0;  ///< 0: the dataset as it is; else thinned by this factor
  std::string label;        ///< "liver.h5", "liver.h5, every 2nd point"
  double spacing = 0;       ///< m, before refinement
};

/// The datasets as they are, the refined ones before that, and of each every 2nd, 3rd and 4th
/// point, but for lattices of a spacing that another one has already, and those with hardly a
/// point.
std::vector<ComparedLattice> latticesIn(const std::vector<Dataset>& datasets);

/// The table of active node `space` on a lattice in `datasets`, which must outlive it.
std::shared_ptr<const SpaceTable> tableOf(const std::vector<Dataset>& datasets,
                                          const ComparedLattice& lattice, std::size_t space);

}  // namespace palpate
