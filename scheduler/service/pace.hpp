#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace palpate {

/// How fast a build goes: equilibria found per second, over the last two minutes of this run.
class Pace {
 public:
  using Time = std::chrono::steady_clock::time_point;
  explicit Pace(Time now) : samples_{{now, 0}} {}

  /// `found`: equilibria since construction. Cheap; call it often.
  void note(Time now, std::int64_t found);
  /// 0 before anything was found.
  double perSecond(Time now, std::int64_t found) const;

 private:
  struct Sample {
    Time when;
    std::int64_t found;
  };
  std::deque<Sample> samples_;  ///< about one a second, oldest first; never empty
};

}  // namespace palpate
