#include "viewer/report/thinned_space.hpp"

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/interpolation/branch_check.hpp"

namespace palpate {

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
  // Of each dense point in the coarse lattice.
  std::vector<std::int32_t> number(space.points.size(), -1);
  const std::int32_t step = factor * dense.divisions();
  for (std::int32_t n = 0; n < coarse.lattice.size(); ++n) {
    LatticePoint point = coarse.lattice.point(n);
    for (std::int32_t& coordinate : point) coordinate *= step;
    const auto found = dense.indexOf(point);
    PALPATE_ASSERT(found, "a lattice has every multiple of its spacing within the radius");
    number[*found] = n;
    coarse.points.push_back(space.points[*found]);
  }
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

}  // namespace palpate
