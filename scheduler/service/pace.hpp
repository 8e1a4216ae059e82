#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace palpate {

/// Mean rate of equilibria, or of all results, over the last two minutes of this run.
class Pace {
 public:
  using Time = std::chrono::steady_clock::time_point;
  explicit Pace(Time now) : samples_{{now, 0}} {}

  /// `found` is the number of results since construction. Cheap; call it often.
  void note(Time now, std::int64_t found);
  /// Returns 0 while nothing was found.
  double perSecond(Time now, std::int64_t found) const;

 private:
  struct Sample {
    Time when;
    std::int64_t found;
  };
  std::deque<Sample> samples_;  ///< about one per second, oldest first; never empty
};

/// Corrects the estimate of a build's remaining time by the errors of earlier estimates of the same
/// build. Estimates are usually too small: refinement adds points, and the points that take longest
/// come last.
class Hindsight {
 public:
  /// worked: seconds in which workers were connected and the build was not paused, up to now.
  /// left: the estimate without correction, s.
  void note(double worked, double left);
  /// Returns a factor for `left`, 1 to 4: the median error factor of the estimates made between 15
  /// and 40 % of the time worked, divided by the usual one. An estimate is compared with the time
  /// worked since then plus `left`.
  double factor(double worked, double left) const;

 private:
  struct Estimate {
    double worked, left;
  };
  std::deque<Estimate> estimates_;  ///< oldest first; those made before 15 % are dropped
};

}  // namespace palpate
