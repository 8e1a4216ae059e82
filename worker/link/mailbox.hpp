#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>

#include "common/problem/problem.hpp"
#include "common/space/configuration.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// A job that is ready to be solved: everything it refers to has arrived.
struct ReadyJob {
  std::shared_ptr<const Problem> problem;
  wire::Job job;
  std::shared_ptr<const NodalFields> start;  ///< null: the rest state
};

/// A solved target on its way to the scheduler.
struct FinishedTarget {
  wire::Result result;
  std::string fields;  ///< payload of `result`; empty for a failure
  bool last_of_job = false;
};

/// Hands jobs from the network thread to the solver thread, and results back. Every call may be
/// made from either thread.
class Mailbox {
 public:
  /// Targets of one job that follow each other faster than `gathers_for` are left to travel
  /// together.
  explicit Mailbox(std::chrono::milliseconds gathers_for = std::chrono::milliseconds(10));
  ~Mailbox();
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  // Network side.
  /// Behind the jobs that wait already.
  void put(ReadyJob job);
  /// Forgets the jobs that wait, and the rest of the one being solved; the target in work is
  /// finished and reported.
  void forgetJobs();
  /// No more jobs: next() returns nothing once the job in work is done (or its present target,
  /// after forgetJobs()).
  void close();
  /// What finish() left since the last call, in its order.
  std::vector<FinishedTarget> takeFinished();
  /// The reason when the solver gave up with an exception.
  std::optional<std::string> solverError();
  /// What the solver is doing now.
  struct Progress {
    wire::Heartbeat heartbeat;  ///< as the scheduler is told
    std::uint64_t begun = 0;    ///< starts made ready and targets, so far
    /// One of them that takes longer hangs (wire::Job.hung_after_s); 0: no limit.
    std::chrono::seconds hung_after{0};
  };
  Progress progress();
  /// A job waits, or is being solved.
  bool hasWork();
  /// Readable while there is something to take; for poll().
  int wakeUpDescriptor() const { return event_; }

  // Solver side.
  /// Waits for a job, if it `waits`. Nothing: closed, end the thread; else, there is none yet.
  std::optional<ReadyJob> next(bool waits = true);
  /// Call before each target. False: the job was forgotten, go on with next().
  [[nodiscard]] bool begin(std::uint64_t job, const wire::Point& target);
  /// Leaves a target for the network thread. Wakes it, unless it was woken a moment ago and the job
  /// goes on.
  void finish(FinishedTarget target);
  /// Last call of the solver thread; `error` empty when it ended well.
  void solverEnds(const std::string& error);

 private:
  void wakeNetwork();

  const std::chrono::milliseconds gathers_for_;
  const int event_;  ///< eventfd
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<ReadyJob> jobs_;
  std::vector<FinishedTarget> finished_;
  std::optional<std::chrono::steady_clock::time_point> woke_;  ///< the network, for one of them
  Progress progress_;
  bool forget_current_ = false, closed_ = false;
  std::optional<std::string> error_;
};

}  // namespace palpate
