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
  /// Returns a factor for `left`, 1 to 4: the median error of the estimates made between 15 % and
  /// 40 % of the time worked, divided by the usual error. The error of an estimate is the time
  /// worked since it was made, plus `left`, divided by the estimate.
  double factor(double worked, double left) const;

 private:
  struct Estimate {
    double worked, left;
  };
  /// oldest first; estimates from the first 15 % of the time worked are dropped
  std::deque<Estimate> estimates_;
};

}  // namespace palpate
