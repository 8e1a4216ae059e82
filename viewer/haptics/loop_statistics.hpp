#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "viewer/haptics/force_guard.hpp"

namespace palpate {

/// Histogram of times with 32 bins per octave from 16 ns to 16 s, so quantiles are accurate to 2.2
/// %. Adding is real time. Copyable.
class TimeHistogram {
 public:
  void add(double seconds) noexcept;
  void add(const TimeHistogram& other) noexcept;
  std::uint64_t count() const { return count_; }
  /// s, upper edge of the bin, at most largest(); 0 if empty
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
  double rate = 0;          ///< requested, Hz
  TimeHistogram period;     ///< from the start of one tick to the next, s
  TimeHistogram latency;    ///< from the due start of a tick to its actual start, s
  TimeHistogram compute;    ///< duration of a tick, s
  TimeHistogram processor;  ///< processor time of a tick, s
  std::uint64_t ticks = 0;
  /// deadlines missed because the tick computed for longer than the period
  std::uint64_t missed_program = 0;
  std::uint64_t missed_system = 0;  ///< all other missed deadlines: woken late or interrupted
  std::uint64_t halts = 0;          ///< number of times the watchdog halted the device
  std::uint64_t page_faults = 0, preemptions = 0;      ///< by the loop's thread (getrusage)
  std::array<std::uint64_t, guard_count> guards = {};  ///< ticks with each Guarded bit
  std::uint64_t not_recorded = 0;  ///< states lost because the recording was too slow
  std::uint64_t contacts = 0;      ///< number of times contact began
  double largest_force = 0;        ///< rendered, N
  double largest_step = 0;         ///< rendered, between ticks, N
};

struct HapticState;
/// Adds one tick to ticks, guards, contacts, largest force and largest step. before: the state of
/// the last tick. Real time.
void count(LoopStatistics& statistics, const HapticState& before,
           const HapticState& state) noexcept;

/// Adds the statistics of another loop: counts and times are summed, maxima kept.
void add(LoopStatistics& total, const LoopStatistics& part) noexcept;

/// Return several lines of text for people, and one JSON object. Times are in microseconds; JSON
/// histograms are pairs [upper edge, count].
std::string describe(const LoopStatistics& statistics);
std::string describeJson(const LoopStatistics& statistics);

}  // namespace palpate
