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

/// Where the scheduler's thread leaves its status for other threads. They cost it nothing while
/// nobody asks; then a status a second at most, and at most a hundredth of its time, however large
/// the build is.
class StatusBoard {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::seconds good_for_at_least{1};
  static constexpr int times_its_cost = 100;

  struct Snapshot {
    std::shared_ptr<const wire::Status> status;  ///< nobody changes it any more
    std::chrono::duration<double> age{};
  };
  /// The latest status, a new one if it is old; waits so long at most for that, and then gives the
  /// old one. Nothing when there never was one. Any thread.
  std::optional<Snapshot> ask(std::chrono::milliseconds patience);

  /// To be called in every turn. Calls `make` when somebody asks and the last status is old. The
  /// scheduler's thread.
  void offer(const std::function<wire::Status()>& make);

 private:
  bool isFresh(Clock::time_point now) const { return status_ && now < good_until_; }

  std::atomic<bool> asked_ = false;
  std::mutex mutex_;
  std::condition_variable made_;
  // Under the mutex.
  std::shared_ptr<const wire::Status> status_;
  Clock::time_point made_at_, good_until_;
};

}  // namespace palpate
