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
/// last one that is known. An adaptive scene is expected to grow as the spaces that have grown did
/// (a fifth, as long as there are few), and one that grows by two fifths more.
///
/// Costs about 0.2 us an unknown point, of most_forecast at most: of more, evenly many are looked
/// at, and each counts for those between.
Forecast forecastOf(const Problem& problem, const std::vector<SpacePlan>& plans);

}  // namespace palpate
