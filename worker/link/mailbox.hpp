#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>

#include "common/base/file_descriptor.hpp"
#include "common/problem/problem.hpp"
#include "common/space/configuration.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// A job that can be solved: all its data has arrived.
struct ReadyJob {
  std::shared_ptr<const Problem> problem;
  wire::Job job;
  std::shared_ptr<const NodalFields> start;  ///< null for the rest state
};

/// The result of a target, to be sent to the scheduler.
struct FinishedTarget {
  wire::Result result;
  std::string fields;  ///< payload of `result`; empty for a failure
  bool last_of_job = false;
};

/// Passes jobs from the network thread to the solver thread, and results back. All calls are
/// allowed from either thread.
class Mailbox {
 public:
  /// While a job continues, the network thread is woken at most once per `gathers_for`, so that
  /// targets which finish soon after each other are sent together.
  explicit Mailbox(std::chrono::milliseconds gathers_for = std::chrono::milliseconds(10));

  // Network side.
  /// Appends a job to the queue.
  void put(ReadyJob job);
  /// Drops the queued jobs and the rest of the current one. The target that is being solved is
  /// finished and reported.
  void forgetJobs();
  /// Announces that no more jobs will come. next() then returns nullopt once the queue is empty.
  void close();
  /// Returns and removes the finished targets, in order.
  std::vector<FinishedTarget> takeFinished();
  /// Returns the message of the exception that stopped the solver; nullopt if none did.
  std::optional<std::string> solverError();
  /// The solver's current work.
  struct Progress {
    wire::Heartbeat heartbeat;  ///< as sent to the scheduler
    std::uint64_t begun = 0;    ///< number of starts and targets begun so far
    /// A start or target that takes longer has hung (wire::Job.hung_after_s). 0: no limit.
    std::chrono::seconds hung_after{0};
  };
  Progress progress();
  /// Returns whether a job is queued or being solved.
  bool hasWork();
  /// Returns a descriptor for poll(). It is readable while there are finished targets.
  int wakeUpDescriptor() const { return event_.get(); }

  // Solver side.
  /// Returns the next job, and waits for one if `waits` is true. Returns nullopt if no job is left
  /// and the mailbox is closed (the thread should then end) or `waits` is false.
  std::optional<ReadyJob> next(bool waits = true);
  /// Announces that the solver begins a target. Returns false if the job was dropped; then call
  /// next().
  [[nodiscard]] bool begin(std::uint64_t job, const wire::Point& target);
  /// Stores a target for the network thread. Wakes that thread, unless it was woken a moment ago
  /// and the job continues.
  void finish(FinishedTarget target);
  /// The solver thread calls this last. `error` is empty after a normal end.
  void solverEnds(const std::string& error);

 private:
  void wakeNetwork();

  const std::chrono::milliseconds gathers_for_;
  const FileDescriptor event_;  ///< eventfd
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ReadyJob> jobs_;
  std::vector<FinishedTarget> finished_;
  std::optional<std::chrono::steady_clock::time_point> woke_;  ///< time of the last wake-up
  Progress progress_;
  bool forget_current_ = false, closed_ = false;
  std::optional<std::string> error_;
};

}  // namespace palpate
