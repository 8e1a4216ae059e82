#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "viewer/haptics/loop_statistics.hpp"

namespace palpate {

/// The numbers of a LoopStatistics that fit beside a picture. Quantiles take a while: some times a
/// second is enough.
struct LoopFigures {
  double rate = 0;                           ///< Hz asked for; 0: no loop runs
  double period_p50 = 0, period_p999 = 0;    ///< s
  double compute_p50 = 0, compute_p999 = 0;  ///< s
  std::uint64_t ticks = 0;
  std::uint64_t missed_program = 0, missed_system = 0, halts = 0;
  std::array<std::uint64_t, guard_count> guards = {};  ///< ticks with each Guarded bit
};
LoopFigures figuresOf(const LoopStatistics& statistics);

/// What a picture shows beside the state of the tick.
struct PictureStatus {
  std::string device;      ///< HapticDevice::name()
  std::string trouble;     ///< of device and loop, sentences; shown in red; empty: none
  std::string notice;      ///< anything else to say, shown in blue; empty: nothing
  double max_force = 3.3;  ///< N, of the device: the longest arrow
  bool paused = false;
  bool recording = false;
  LoopFigures loop;
};

}  // namespace palpate
