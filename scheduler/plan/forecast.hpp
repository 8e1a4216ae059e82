#pragma once

#include <vector>

#include "scheduler/plan/space_plan.hpp"

namespace palpate {

/// How many points and probes will still be tried: what is ready for certain, the rest by what is
/// known of points nearer to rest and of spaces that are further.
struct Forecast {
  double ready = 0;     ///< transitions that wait or are being solved
  double expected = 0;  ///< points that will become ready, or be asked for by refinement
};

inline constexpr std::int64_t most_forecast = 50000;

/// An unknown point of a lattice counts as much as what lies on the straight way to it from rest
/// lets it: not at all behind a point where the way ended, less and less the farther it is from the
/// last one that is known. A space is expected to grow as those that have grown did (by a fifth, as
/// long as there are few), and once its refinement has begun by what its cells want.
///
/// Costs about 0.2 us an unknown point, of most_forecast at most: of more, evenly many are looked
/// at, and each counts for those between.
Forecast forecastOf(const Problem& problem, const std::vector<SpacePlan>& plans);

}  // namespace palpate
