#pragma once

#include <vector>

#include "scheduler/plan/space_plan.hpp"

namespace palpate {

/// Estimated number of attempts still to be made, at points and probes.
struct Forecast {
  double ready = 0;     ///< number of transitions that wait or are being solved
  double expected = 0;  ///< estimated number of attempts that become ready later
};

inline constexpr std::int64_t most_forecast = 50000;

/// Estimates the remaining work of a build.
///
/// A lattice point that has not been tried is counted with the probability that it will be. This
/// probability follows from the outermost tried point on the straight line from rest to it. If no
/// transition may start from that tried point, the probability is zero. Otherwise it falls with the
/// distance between the two points.
///
/// Refinement is expected to enlarge a space by the same fraction as it enlarged the finished
/// spaces (by a fifth while few are finished). Once refinement of a space has begun, its own
/// forecast is used (Refinement::later).
///
/// Costs about 0.2 us per unknown point. If there are more than most_forecast lattice points, only
/// an evenly spaced sample is evaluated; each sampled point then stands for the points up to the
/// next one.
Forecast forecastOf(const Problem& problem, const std::vector<SpacePlan>& plans);

}  // namespace palpate
