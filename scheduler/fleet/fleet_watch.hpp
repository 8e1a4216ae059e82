#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "common/wire/wire.hpp"
#include "scheduler/builds/asked_scheduler.hpp"

namespace palpate {

/// A scheduler that a fleet works for, which may be restarted meanwhile. One thread.
class FleetWatch {
 public:
  explicit FleetWatch(const Asked& asked) : asked_(asked), heard_(Clock::now()) {}

  /// What it says by now; of a directory in which nobody works any more that it is complete, when
  /// it is. Nothing when nobody answers, which is told once (log), or a signal came first
  /// (interrupted()). Error (bad input) when it makes no sense to ask there, and never did.
  std::optional<wire::Status> look();
  /// Since it was heard last.
  std::chrono::steady_clock::duration silence() const { return Clock::now() - heard_; }

 private:
  using Clock = std::chrono::steady_clock;

  Asked asked_;
  Clock::time_point heard_;
  bool answered_ = false;  ///< once
  std::string told_;
};

}  // namespace palpate
