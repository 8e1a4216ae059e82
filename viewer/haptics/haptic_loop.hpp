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
  bool free_running = false;  ///< run ticks as fast as possible, without a clock (tests, --fast)
  double watchdog = 0.1;      ///< time without a tick until the device is halted, s
  std::uint64_t ticks = 0;    ///< number of ticks until the loop stops; 0: never
  /// Whether to put every state into a queue for takeRecorded(). The queue holds 8192 states. If it
  /// is full, further states are dropped and counted; a free-running loop waits instead.
  bool record = false;
};

/// Runs a HapticTick at its rate in its own thread, supervised by a watchdog thread.
///
/// The loop sleeps until absolute times (clock_nanosleep, CLOCK_MONOTONIC), so the rate does not
/// drift. A tick that ends after the start of the next one is a missed deadline; the loop then
/// continues from the current time and does not catch up. A miss is attributed to the program if
/// the tick took more processor time than the period, otherwise to the operating system.
///
/// If no tick ends for `watchdog` seconds, the watchdog thread halts the device and counts the
/// halt. When the ticks continue, the loop starts from zero force (Guarded::late). It also does so
/// if it notices the gap before the watchdog does, or if another loop ran the HapticTick before.
///
/// The watchdog also halts a lost device, because the device's own thread may hang and hold the
/// last force. The device is resumed after the first tick in which it is not lost. That tick is
/// treated as late and writes zero. A free-running loop has no watchdog. With real_time the
/// watchdog's priority is one above the loop's, and the priority of the device's threads one below
/// (real_time.hpp).
///
/// Threads: latest(), command() and takeRecorded() may each be called from one thread, all other
/// functions only by the owner. The drawing thread calls latest().
class HapticLoop {
 public:
  /// tick and device must outlive this object, and the tick must use this device. Throws Error if
  /// the rate is not 1 / period of the tick, or if the watchdog is not positive.
  HapticLoop(HapticTick& tick, HapticDevice& device, const LoopOptions& options);
  ~HapticLoop();  ///< stops the loop
  void start();   ///< once only; throws Error if a thread cannot be created
  void stop();    ///< writes zero force last and completes the statistics
  /// Returns true from start() until the loop has ended (stop(), LoopOptions::ticks).
  bool running() const noexcept { return running_.load(std::memory_order_acquire); }

  const HapticState& latest() noexcept { return states_.read(); }
  /// Sends a command to the loop. Returns false if the queue is full, because the loop hangs.
  bool command(const HapticCommand& command) noexcept { return commands_.push(command); }
  /// Returns the next recorded state; nullopt if no state is waiting.
  std::optional<HapticState> takeRecorded();
  /// Returns the statistics so far. They may be a tenth of a second old; after stop() they are
  /// final.
  LoopStatistics statistics() const;
  /// Returns a sentence for each real-time request that the system refused; empty if there is none.
  /// Complete after start().
  std::string trouble() const { return trouble_; }

 private:
  static constexpr std::size_t recorded_states = 8192;
  using RecordedQueue =
      boost::lockfree::spsc_queue<HapticState, boost::lockfree::capacity<recorded_states>>;
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
  std::unique_ptr<RecordedQueue> recorded_;  ///< null unless recording
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

  // Shared by the owner, the loop's thread and the watchdog, but not used during ticks.
  std::mutex waiting_;
  std::condition_variable woken_;
  bool prepared_ = false;  ///< guarded by waiting_
};

}  // namespace palpate
