#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/haptics/loop_statistics.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

struct LoopOptions {
  double rate = 1000;      ///< Hz
  bool real_time = false;  ///< ask for SCHED_FIFO and mlockall; refusals are told in trouble()
  bool free_running =
      false;  ///< no clock: one tick after the other, as fast as possible (tests, --duration without a hand)
  double watchdog = 0.1;    ///< s without a tick, after which the device is halted
  std::uint64_t ticks = 0;  ///< stop after so many; 0: never
  bool record = false;      ///< fill the queue that takeRecorded() empties
};

/// Runs a HapticTick at its rate on a thread of its own, and a watchdog beside it.
///
/// Absolute-time sleeps (clock_nanosleep, CLOCK_MONOTONIC): the rate does not drift. A tick that ends after
/// the next should have begun is a missed deadline; the loop then goes on from now, without catching up. It
/// is the program's when the thread itself computed for longer than the period (its processor time), the
/// operating system's otherwise.
///
/// When no tick ends for `watchdog` seconds the watchdog thread halts the device, counts, and the loop starts
/// from zero force when it comes back (Guarded::late).
///
/// Other threads: latest() from one thread (the picture), command() from one thread, takeRecorded() from one
/// thread, the rest from the owner.
class HapticLoop {
 public:
  HapticLoop(HapticTick& tick, HapticDevice& device, const LoopOptions& options);
  ~HapticLoop();  ///< stops
  void start();   ///< Error when no thread can be had
  void stop();    ///< zero force is written last; the statistics are complete then
  bool running() const noexcept;

  const HapticState& latest() noexcept { return states_.read(); }
  /// False when the queue is full (the loop hangs).
  bool command(const HapticCommand& command) noexcept { return commands_.push(command); }
  /// The next state that was recorded; empty when there is none yet.
  std::optional<HapticState> takeRecorded();
  /// Statistics so far; exact after stop().
  LoopStatistics statistics() const;
  /// What real time asked for and did not get, as a sentence; empty when nothing.
  std::string trouble() const;

 private:
  HapticTick& tick_;
  HapticDevice& device_;
  LoopOptions options_;
  TripleBuffer<HapticState> states_;
  boost::lockfree::spsc_queue<HapticCommand, boost::lockfree::capacity<64>> commands_;
};

}  // namespace palpate
