#pragma once

#include <vector>

#include "scheduler/plan/space_plan.hpp"

namespace palpate {

/// Estimated number of points and probes still to be tried.
struct Forecast {
  double ready = 0;     ///< open transitions: waiting or being solved; exact
  double expected = 0;  ///< points that will become ready or that refinement adds; estimated
};

inline constexpr std::int64_t most_forecast = 50000;

/// Estimates the remaining work of a build.
///
/// An unknown lattice point counts with the probability that it is tried, which follows from the
/// straight path to it from rest. The probability is zero behind a point where solving ended, and
/// falls with the distance from the last known point. A space is expected to grow by refinement as
/// the finished ones did (by a fifth while few are finished). Once its own refinement has begun,
/// the forecast of its cells is used.
///
/// Costs about 0.2 us per unknown point. With more than most_forecast lattice points an evenly
/// spaced sample is evaluated, and each sampled point stands for those in between.
Forecast forecastOf(const Problem& problem, const std::vector<SpacePlan>& plans);

}  // namespace palpate
