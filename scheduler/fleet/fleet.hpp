#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "scheduler/builds/asked_scheduler.hpp"

namespace palpate {

/// What a fleet of any engine is told.
struct FleetOptions {
  Asked asked;
  std::string endpoint;  ///< of the scheduler, as nodes reach it
  int every_s = 30;
  int give_up_s = 900;
  bool dry_run = false;
};

/// A scheduler that a fleet works for, which may be restarted meanwhile. One thread.
class FleetWatch {
 public:
  /// `options` must outlive it.
  explicit FleetWatch(const FleetOptions& options) : options_(options) {}

  /// What it says by now; of a directory in which nobody works any more that it is complete, when
  /// it is. Nothing when nobody answers, which is told once (log), or a signal came first
  /// (interrupted()). Error (bad input) when it makes no sense to ask there, and never did.
  std::optional<wire::Status> look();
  /// It was silent for give_up_s.
  bool gaveUp() const { return Clock::now() - heard_ > std::chrono::seconds(options_.give_up_s); }

 private:
  using Clock = std::chrono::steady_clock;

  const FleetOptions& options_;
  Clock::time_point heard_ = Clock::now();
  bool answered_ = false;  ///< once
  std::string told_;
};

/// What a fleet sees when it decides.
struct FleetView {
  std::int64_t ready = 0;  ///< transitions that could be solved now
  int queued = 0;          ///< workers that the engine was asked for and has not started
  int running = 0;         ///< those that it runs
  bool hands_out = true;   ///< the scheduler is neither paused nor about to end
};

struct FleetLimits {
  int most = 64;             ///< workers, queued ones included
  int most_queued = 16;      ///< at once: a queue that is full of them helps nobody
  int transitions_each = 2;  ///< a worker is worth its start when so many wait for it
};

/// How many workers more to ask for; negative: so many queued ones are not needed any more, because
/// the frontier became narrow, and are to be cancelled. Those that run leave by themselves when
/// they have nothing to do. After HyperQueue's automatic allocation (backlog, most workers, least
/// use), with the frontier in the place of its queue of tasks.
int moreWorkers(const FleetView& view, const FleetLimits& limits);

}  // namespace palpate
