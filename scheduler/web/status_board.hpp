#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>

#include "proto/palpate.pb.h"

namespace palpate {

/// Passes the status from the scheduler's thread to other threads. Costs the scheduler nothing
/// while no thread asks. Otherwise a status is made at most once a second, and less often if that
/// would take more than 1 % of the scheduler's time.
class StatusBoard {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds good_for_at_least{1};
  static constexpr int times_its_cost = 100;

  struct Snapshot {
    std::shared_ptr<const wire::Status> status;  ///< immutable
    std::chrono::duration<double> age{};
  };
  /// Returns the latest status. If it is old, waits up to `patience` for a new one, and returns the
  /// old one if none comes. Returns none if no status was ever made. Any thread.
  std::optional<Snapshot> ask(std::chrono::milliseconds patience);

  /// Calls `make` if a thread has asked and the last status is old. Call in every turn, on the
  /// scheduler's thread.
  void offer(const std::function<wire::Status()>& make);

 private:
  bool isFresh(Clock::time_point now) const { return status_ && now < good_until_; }

  std::atomic<bool> asked_ = false;
  std::mutex mutex_;
  std::condition_variable made_;
  // Guarded by the mutex.
  std::shared_ptr<const wire::Status> status_;
  Clock::time_point made_at_, good_until_;
};

}  // namespace palpate
