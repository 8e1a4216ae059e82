#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "scheduler/builds/asked_scheduler.hpp"

namespace palpate {

/// Options of a fleet, for every engine (Slurm or ssh).
struct FleetOptions {
  Asked asked;
  std::string endpoint;  ///< address at which nodes reach the scheduler
  int every_s = 30;
  int give_up_s = 900;
  bool dry_run = false;
};

/// Watches the scheduler that a fleet works for, across its restarts. One thread.
class FleetWatch {
 public:
  /// `options` must outlive this object.
  explicit FleetWatch(const FleetOptions& options) : options_(options) {}

  /// Returns the scheduler's status. If no scheduler runs but the build in the state directory is
  /// complete, returns its status. Returns none if no scheduler answers (logs each reason once), or
  /// if a signal comes first (interrupted()). Throws Error (bad input) if the address is invalid
  /// and no scheduler ever answered there.
  std::optional<wire::Status> look();
  /// Returns true if the scheduler has been silent for give_up_s.
  bool gaveUp() const { return Clock::now() - heard_ > std::chrono::seconds(options_.give_up_s); }

 private:
  using Clock = std::chrono::steady_clock;

  const FleetOptions& options_;
  Clock::time_point heard_ = Clock::now();
  bool answered_ = false;  ///< the scheduler has answered at least once
  std::string told_;
};

/// The input of moreWorkers().
struct FleetView {
  std::int64_t ready = 0;  ///< number of transitions that could be solved now
  int queued = 0;          ///< number of workers requested from the engine and not started
  int running = 0;         ///< number of workers that the engine runs
  bool hands_out = true;   ///< the scheduler is neither paused nor ending
};

struct FleetLimits {
  int most = 64;             ///< limit on all workers, including queued ones
  int most_queued = 16;      ///< limit on queued workers: a longer queue gains nothing
  int transitions_each = 2;  ///< number of ready transitions per requested worker
};

/// Returns the number of workers to request, or, if too few transitions are ready, minus the number
/// of queued workers to cancel. Running workers leave by themselves when they are idle. Follows the
/// automatic allocation of HyperQueue, with ready transitions in place of HyperQueue's task queue.
int moreWorkers(const FleetView& view, const FleetLimits& limits);

}  // namespace palpate
