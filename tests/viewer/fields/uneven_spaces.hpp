#pragma once

#include "common/base/index.hpp"
#include "tests/support/points_in_ball.hpp"
#include "tests/support/sample_dataset.hpp"

/// Spaces of StiffeningEnergy in the ball of points_in_ball.hpp that are not the same all over.
namespace palpate::test {

/// The cell between the origin and (1, 1, 1) split once, all of its corners solved.
inline SpaceTable refinedSpace(double spacing) {
  Lattice lattice(radius, spacing, 1024);
  for (std::int32_t i = 0; i <= 2; ++i)
    for (std::int32_t j = 0; j <= 2; ++j)
      for (std::int32_t k = 0; k <= 2; ++k)
        if (const LatticePoint p{512 * i, 512 * j, 512 * k}; !lattice.indexOf(p)) lattice.add(p);
  SpaceTable space = solvedSpace(lattice, StiffeningEnergy());
  space.splits = {{{0, 0, 0}, 0}};
  return space;
}

/// Three of the points not solved.
inline SpaceTable holedSpace(double spacing) {
  SpaceTable space = solvedSpace(Lattice(radius, spacing), StiffeningEnergy());
  for (const LatticePoint& hole :
       {LatticePoint{1, 0, 0}, LatticePoint{1, 1, 0}, LatticePoint{0, -2, 1}})
    space.points[at(*space.lattice.indexOf(hole))] = {};
  return space;
}

}  // namespace palpate::test
