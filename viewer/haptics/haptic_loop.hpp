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
  bool real_time = false;     ///< request SCHED_FIFO and mlockall; see trouble() for refusals
  bool free_running = false;  ///< no clock: one tick after the other, as fast as possible (tests,
                              ///< palpate view --fast)
  double watchdog = 0.1;      ///< time without a tick until the device is halted, s
  std::uint64_t ticks = 0;    ///< number of ticks until the loop stops; 0: never
  /// Fill the queue for takeRecorded(), which holds 8192 states. A full queue drops states and
  /// counts them; a free-running loop waits instead.
  bool record = false;
};

/// Runs a HapticTick at its rate in its own thread, supervised by a watchdog thread.
///
/// Sleeps until absolute times (clock_nanosleep, CLOCK_MONOTONIC), so the rate does not drift. A
/// tick that ends after the start of the next one is a missed deadline; the loop then continues
/// from now and does not catch up. The program missed the deadline if the thread itself computed
/// for longer than the period (its processor time); otherwise the operating system did.
///
/// If no tick ends for `watchdog` seconds, the watchdog thread halts the device and counts the
/// halt. The loop starts from zero force when it returns (Guarded::late). It also restarts from
/// zero if it notices such a gap itself, or resumes a tick that another loop ran.
///
/// The watchdog also halts a lost device, because its own thread may hang and hold the last force.
/// The device is resumed after the first tick that is not lost; that tick is late and writes zero.
/// A free-running loop has no watchdog. With real_time the watchdog's priority is one above the
/// loop's, and the priority of the device's threads one below (real_time.hpp).
///
/// Threads: latest(), command() and takeRecorded() each from one thread, the rest from the owner.
/// The picture calls latest().
class HapticLoop {
 public:
  /// tick and device must outlive this object; the tick must use this device. Throws Error if the
  /// rate is not 1 / period of the tick or the watchdog is not positive.
  HapticLoop(HapticTick& tick, HapticDevice& device, const LoopOptions& options);
  ~HapticLoop();  ///< stops
  HapticLoop(const HapticLoop&) = delete;
  HapticLoop& operator=(const HapticLoop&) = delete;
  void start();  ///< Error if no thread can be created; once only
  void stop();   ///< writes zero force last and completes the statistics
  /// Returns true from start() until the last tick, by stop() or LoopOptions::ticks.
  bool running() const noexcept { return running_.load(std::memory_order_acquire); }

  const HapticState& latest() noexcept { return states_.read(); }
  /// Returns false if the queue is full (the loop hangs).
  bool command(const HapticCommand& command) noexcept { return commands_.push(command); }
  /// Returns the next recorded state; empty if there is none yet.
  std::optional<HapticState> takeRecorded();
  /// Returns the statistics so far, at most a tenth of a second old; exact after stop().
  LoopStatistics statistics() const;
  /// Returns the refused real-time requests as sentences; empty if there are none. Complete after
  /// start().
  std::string trouble() const { return trouble_; }

 private:
  static constexpr std::size_t recorded_states = 8192;
  using RecordedQueue =
      boost::lockfree::spsc_queue<HapticState, boost::lockfree::capacity<recorded_states>>;
  /// Counts of the loop's thread when the loop begins.
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
  std::unique_ptr<RecordedQueue> recorded_;  ///< only when recording
  mutable TripleBuffer<LoopStatistics> published_;

  // Used by the owner, and by the loop's thread before start() returns.
  std::thread thread_, watchdog_;
  std::string trouble_;
  bool started_ = false, memory_locked_ = false;

  // Used by the loop's thread only.
  LoopStatistics statistics_;
  HapticState before_;
  Usage usage_at_start_;
  std::int64_t last_begin_ns_ = 0;  ///< 0: no tick yet

  // Shared by the loop's thread, the watchdog and the owner.
  std::atomic<bool> stop_ = false, running_ = false;
  std::atomic<std::uint64_t> ticks_done_ = 0, halts_ = 0;
  /// set by the watchdog after halt(), cleared by the loop after resume()
  std::atomic<bool> halted_ = false;
  std::atomic<bool> lost_ = false;  ///< the device was lost in the last tick

  // Shared by owner, loop and watchdog outside the ticks.
  std::mutex waiting_;
  std::condition_variable woken_;
  bool prepared_ = false;  ///< guarded by waiting_
};

}  // namespace palpate
