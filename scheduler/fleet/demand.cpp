#include "scheduler/fleet/demand.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

int moreWorkers(const FleetView& view, const FleetLimits& limits) {
  PALPATE_ASSERT(view.queued >= 0 && view.running >= 0 && limits.transitions_each > 0,
                 "counts of jobs, and a command line that was checked");
  std::int64_t worth = view.hands_out ? view.ready / limits.transitions_each : 0;
  // The first transition is one, and the last ones are few.
  if (view.hands_out && view.ready > 0) worth = std::max<std::int64_t>(worth, 1);
  const int wanted = static_cast<int>(std::min<std::int64_t>(worth, limits.most));
  const int missing = wanted - view.running - view.queued;
  if (missing < 0) return -std::min(-missing, view.queued);
  return std::min(missing, std::max(0, limits.most_queued - view.queued));
}

}  // namespace palpate
