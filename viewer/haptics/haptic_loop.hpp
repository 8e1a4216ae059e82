#pragma once

#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "viewer/haptics/haptic_tick.hpp"
#include "viewer/haptics/loop_statistics.hpp"
#include "viewer/haptics/triple_buffer.hpp"

namespace palpate {

struct LoopOptions {
  double rate = 1000;         ///< Hz
  bool real_time = false;     ///< ask for SCHED_FIFO and mlockall; refusals are told in trouble()
  bool free_running = false;  ///< no clock: one tick after the other, as fast as possible (tests,
                              ///< palpate view --fast)
  double watchdog = 0.1;      ///< s without a tick, after which the device is halted
  std::uint64_t ticks = 0;    ///< stop after so many; 0: never
  /// Fill the queue that takeRecorded() empties; it holds 8192 states. When it is full, states are
  /// lost and counted; a free-running loop waits instead.
  bool record = false;
};

/// Runs a HapticTick at its rate on a thread of its own, and a watchdog beside it.
///
/// Absolute-time sleeps (clock_nanosleep, CLOCK_MONOTONIC): the rate does not drift. A tick that
/// ends after the next should have begun is a missed deadline; the loop then goes on from now,
/// without catching up. It is the program's when the thread itself computed for longer than the
/// period (its processor time), the operating system's otherwise.
///
/// When no tick ends for `watchdog` seconds the watchdog thread halts the device, counts, and the
/// loop starts from zero force when it comes back (Guarded::late). So it does when it finds by
/// itself that it was away for so long, and when it goes on with a tick that ran before.
///
/// While the device is lost the watchdog keeps it halted too: a device whose own thread hangs would
/// go on with the last force. It is resumed after the first tick that is not lost, which is late
/// and writes zero. A free-running loop has no watchdog. With real_time the watchdog has one
/// priority more than the loop, and threads of the device have one less (real_time.hpp).
///
/// Other threads: latest() from one thread (the picture), command() from one thread, takeRecorded()
/// from one thread, the rest from the owner.
class HapticLoop {
 public:
  /// tick and device must outlive this object; the device is that of the tick. The rate is the
  /// tick's: Error when it is not 1 / period, or the watchdog is not positive.
  HapticLoop(HapticTick& tick, HapticDevice& device, const LoopOptions& options);
  ~HapticLoop();  ///< stops
  HapticLoop(const HapticLoop&) = delete;
  HapticLoop& operator=(const HapticLoop&) = delete;
  void start();  ///< Error when no thread can be had; once only
  void stop();   ///< zero force is written last; the statistics are complete then
  /// From start() until the last tick: stop(), or LoopOptions::ticks.
  bool running() const noexcept { return running_.load(std::memory_order_acquire); }

  const HapticState& latest() noexcept { return states_.read(); }
  /// False when the queue is full (the loop hangs).
  bool command(const HapticCommand& command) noexcept { return commands_.push(command); }
  /// The next state that was recorded; empty when there is none yet.
  std::optional<HapticState> takeRecorded();
  /// Statistics so far, at most a tenth of a second old; exact after stop().
  LoopStatistics statistics() const;
  /// What real time asked for and did not get, as sentences; empty when nothing. Complete after
  /// start().
  std::string trouble() const { return trouble_; }

 private:
  static constexpr std::size_t recorded_states = 8192;
  using RecordedQueue =
      boost::lockfree::spsc_queue<HapticState, boost::lockfree::capacity<recorded_states>>;
  /// Of the thread in the loop, at its begin.
  struct Usage {
    std::uint64_t page_faults = 0, preemptions = 0;
  };

  void lockMemory();
  void runLoop();
  void runTicks();
  bool oneTick(std::int64_t begin_ns);
  void hand(const HapticState& state) noexcept;
  void publishStatistics() noexcept;
  void watch();
  static Usage usage() noexcept;

  HapticTick& tick_;
  HapticDevice& device_;
  const LoopOptions options_;
  TripleBuffer<HapticState> states_;
  boost::lockfree::spsc_queue<HapticCommand, boost::lockfree::capacity<64>> commands_;
  std::unique_ptr<RecordedQueue> recorded_;  ///< when recording
  mutable TripleBuffer<LoopStatistics> published_;

  // The owner's; the loop's thread before start() returns.
  std::thread thread_, watchdog_;
  std::string trouble_;
  bool started_ = false, memory_locked_ = false;

  // The loop's thread alone.
  LoopStatistics statistics_;
  HapticState before_;
  Usage usage_at_start_;
  std::int64_t last_begin_ns_ = 0;  ///< 0: no tick yet

  // Between the loop's thread, the watchdog and the owner.
  std::atomic<bool> stop_ = false, running_ = false;
  std::atomic<std::uint64_t> ticks_done_ = 0, halts_ = 0;
  /// set by the watchdog after halt(), cleared by the loop after resume()
  std::atomic<bool> halted_ = false;
  std::atomic<bool> lost_ = false;  ///< the device, in the last tick

  // Between owner, loop and watchdog outside of the ticks.
  std::mutex waiting_;
  std::condition_variable woken_;
  bool prepared_ = false;  ///< guarded by waiting_
};

}  // namespace palpate
