#include "scheduler/fleet_watch.hpp"

#include <spdlog/spdlog.h>

#include "scheduler/recorded_build.hpp"

namespace palpate {
namespace {

/// Of a directory in which nobody works.
wire::Status ended(const std::string& directory) {
  wire::Status status = progressIn(directory);
  if (status.state() != "complete")
    throw failure(
        "{}: no scheduler is working there now: start palpate serve again, or, when it moved, this "
        "command with its new place",
        directory);
  return status;
}

}  // namespace

std::optional<wire::Status> FleetWatch::look() {
  try {
    const auto scheduler = schedulerOf(asked_);
    wire::Status status = scheduler ? askStatus(*scheduler, asked_.where) : ended(asked_.where);
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
