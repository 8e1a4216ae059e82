#include "scheduler/fleet/fleet_watch.hpp"

#include <spdlog/spdlog.h>

namespace palpate {
std::optional<wire::Status> FleetWatch::look() {
  try {
    wire::Status status = statusAt(asked_);
    if (status.state() == "stopped")
      throw failure(
          "{}: no scheduler is working there now: start palpate serve again, or, when it moved, "
          "this command with its new place",
          asked_.where);
    heard_ = Clock::now();
    answered_ = true;
    told_.clear();
    return status;
  } catch (const Error& error) {
    // Where it was asked before, the directory was moved or removed, and may come back.
    if (error.exitCode() == ExitCode::usage && !answered_) throw;
    if (error.exitCode() == ExitCode::interrupted) return std::nullopt;
    if (told_ != error.what()) spdlog::warn("{}", error.what());
    told_ = error.what();
    return std::nullopt;
  }
}

}  // namespace palpate
