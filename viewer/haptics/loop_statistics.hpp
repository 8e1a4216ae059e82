#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "viewer/haptics/force_guard.hpp"

namespace palpate {

/// Histogram of times from 16 ns to 16 s. It has 32 bins per octave, so quantiles are accurate to
/// 2.2 %. Adding is real time. Copyable.
class TimeHistogram {
 public:
  void add(double seconds) noexcept;
  void add(const TimeHistogram& other) noexcept;
  std::uint64_t count() const { return count_; }
  /// Returns the upper edge of the bin that contains the quantile, s, but at most largest(); 0 if
  /// the histogram is empty.
  double quantile(double share) const;
  double largest() const { return largest_; }  ///< s, exact
  double mean() const;                         ///< s
  struct Bin {
    double upper_edge;  ///< s
    std::uint64_t count;
  };
  std::vector<Bin> bins() const;  ///< the bins that are not empty, in order

 private:
  static double upperEdge(std::size_t bin);  ///< s
  static constexpr int bins_per_octave = 32, octaves = 30;
  std::array<std::uint64_t, static_cast<std::size_t>(bins_per_octave* octaves)> bins_ = {};
  std::uint64_t count_ = 0;
  double sum_ = 0, largest_ = 0;
};

/// Measurements of a haptic loop. Times are by CLOCK_MONOTONIC unless noted.
struct LoopStatistics {
  double rate = 0;          ///< requested rate, Hz
  TimeHistogram period;     ///< time from the start of one tick to the next, s
  TimeHistogram latency;    ///< time from the scheduled to the actual start of a tick, s
  TimeHistogram compute;    ///< duration of a tick, s
  TimeHistogram processor;  ///< processor time of a tick, s
  std::uint64_t ticks = 0;
  /// missed deadlines because the tick computed for longer than the period
  std::uint64_t missed_program = 0;
  std::uint64_t missed_system = 0;  ///< all other missed deadlines: the thread was woken late or
                                    ///< interrupted
  std::uint64_t halts = 0;          ///< number of times the watchdog halted the device
  std::uint64_t page_faults = 0, preemptions = 0;      ///< of the loop's thread (getrusage)
  std::array<std::uint64_t, guard_count> guards = {};  ///< number of ticks with each Guarded bit
  std::uint64_t not_recorded = 0;  ///< number of states lost because the recording was too slow
  std::uint64_t contacts = 0;      ///< number of times contact began
  double largest_force = 0;        ///< N, largest rendered force
  double largest_step = 0;         ///< N, largest change of the rendered force between two ticks
};

struct HapticState;
/// Adds one tick to ticks, guards, contacts, largest_force and largest_step. before: the state of
/// the previous tick. Real time.
void count(LoopStatistics& statistics, const HapticState& before,
           const HapticState& state) noexcept;

/// Adds the statistics of another loop. Counts and times are summed; of two maxima the larger is
/// kept.
void add(LoopStatistics& total, const LoopStatistics& part) noexcept;

/// Return the statistics as several lines of text for people, and as one JSON object. Times are in
/// microseconds. In JSON a histogram is a list of pairs [upper edge, count].
std::string describe(const LoopStatistics& statistics);
std::string describeJson(const LoopStatistics& statistics);

}  // namespace palpate
