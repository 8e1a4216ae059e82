#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "viewer/haptics/force_guard.hpp"

namespace palpate {

/// Counts times by size, 32 bins per octave from 16 ns to 16 s: quantiles are right to 2.2 %.
/// Adding is real time. Copyable.
class TimeHistogram {
 public:
  void add(double seconds) noexcept;
  void add(const TimeHistogram& other) noexcept;
  std::uint64_t count() const { return count_; }
  /// s, upper edge of the bin, at most largest(); 0 when empty
  double quantile(double share) const;
  double largest() const { return largest_; }  ///< s, exact
  double mean() const;                         ///< s
  struct Bin {
    double upper_edge;  ///< s
    std::uint64_t count;
  };
  std::vector<Bin> bins() const;  ///< those that are not empty, in order

 private:
  static double upperEdge(std::size_t bin);  ///< s
  static constexpr int bins_per_octave = 32, octaves = 30;
  std::array<std::uint64_t, static_cast<std::size_t>(bins_per_octave* octaves)> bins_ = {};
  std::uint64_t count_ = 0;
  double sum_ = 0, largest_ = 0;
};

/// How a haptic loop did. Times by CLOCK_MONOTONIC unless said otherwise.
struct LoopStatistics {
  double rate = 0;          ///< Hz asked for
  TimeHistogram period;     ///< s from the begin of one tick to that of the next
  TimeHistogram latency;    ///< s from when a tick should begin to when it does
  TimeHistogram compute;    ///< s that a tick takes
  TimeHistogram processor;  ///< s of processor time that a tick takes
  std::uint64_t ticks = 0;
  /// deadlines missed because the tick computed for more than the period
  std::uint64_t missed_program = 0;
  std::uint64_t missed_system = 0;  ///< all other missed deadlines: woken late, or interrupted
  std::uint64_t halts = 0;          ///< times that the watchdog halted the device
  std::uint64_t page_faults = 0, preemptions = 0;      ///< of the thread in the loop (getrusage)
  std::array<std::uint64_t, guard_count> guards = {};  ///< ticks with each Guarded bit
  std::uint64_t not_recorded = 0;  ///< states lost because the recording was too slow
  std::uint64_t contacts = 0;      ///< times that contact began
  double largest_force = 0;        ///< N, rendered
  double largest_step = 0;         ///< N between ticks, rendered
};

struct HapticState;
/// Counts one tick, after `before`: ticks, guards, contacts, largest force and step. Real time.
void count(LoopStatistics& statistics, const HapticState& before,
           const HapticState& state) noexcept;

/// Adds the run of another loop: counts and times add up, the largest stays.
void add(LoopStatistics& total, const LoopStatistics& part) noexcept;

/// For a person, several lines; and one JSON object: times in microseconds, histograms as pairs
/// [upper edge, count].
std::string describe(const LoopStatistics& statistics);
std::string describeJson(const LoopStatistics& statistics);

}  // namespace palpate
