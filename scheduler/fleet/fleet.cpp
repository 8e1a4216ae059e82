#include "scheduler/fleet/fleet.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

std::optional<wire::Status> FleetWatch::look() {
  try {
    wire::Status status = statusAt(options_.asked);
    if (status.state() == "stopped")
      throw failure(
          "{}: no scheduler is running there: start palpate serve again, or, if it moved, run this "
          "command with its new address",
          options_.asked.where);
    heard_ = Clock::now();
    answered_ = true;
    told_.clear();
    return status;
  } catch (const Error& error) {
    // If the scheduler answered before, its directory was moved or removed and may come back.
    if (error.exitCode() == ExitCode::usage && !answered_) throw;
    if (error.exitCode() == ExitCode::interrupted) return std::nullopt;
    if (told_ != error.what()) spdlog::warn("{}", error.what());
    told_ = error.what();
    return std::nullopt;
  }
}

int moreWorkers(const FleetView& view, const FleetLimits& limits) {
  PALPATE_ASSERT(view.queued >= 0 && view.running >= 0 && limits.transitions_each > 0,
                 "counts must be >= 0, and transitions_each positive");
  std::int64_t worth = view.hands_out ? view.ready / limits.transitions_each : 0;
  // One ready transition, as at the start of a build, needs a worker too.
  if (view.hands_out && view.ready > 0) worth = std::max<std::int64_t>(worth, 1);
  const int wanted = static_cast<int>(std::min<std::int64_t>(worth, limits.most));
  const int missing = wanted - view.running - view.queued;
  if (missing < 0) return -std::min(-missing, view.queued);
  const int more = std::min(missing, std::max(0, limits.most_queued - view.queued));
  PALPATE_ASSERT(
      more + view.running + view.queued <= std::max(limits.most, view.running + view.queued),
      "requested workers must stay within the limit");
  return more;
}

}  // namespace palpate
