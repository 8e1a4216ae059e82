#pragma once

#include <cstdint>

namespace palpate {

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
