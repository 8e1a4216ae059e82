#pragma once

#include "common/space/space_table.hpp"

namespace palpate {

/// What a build with `factor` times the spacing would have found: the uniform lattice points whose
/// coordinates, in spacings, are multiples of `factor`, with their records. No refinement and no
/// splits, so that factor 1 is the space as it was before it was refined. Parents and attempts that
/// are gone become the origin, or are dropped; the probes stay. Error when factor < 1, or factor
/// times the spacing exceeds the radius (isThinnable).
SpaceTable thinned(const SpaceTable& space, std::int32_t factor);

/// A lattice with `factor` times the spacing has more than the origin.
bool isThinnable(const Lattice& lattice, std::int32_t factor);

}  // namespace palpate
