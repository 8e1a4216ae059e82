#pragma once

#include <deque>

#include "common/wire/wire.hpp"
#include "scheduler/service/service_state.hpp"
#include "scheduler/service/worker_registry.hpp"

namespace palpate {

/// The workers and their leases. Handles workers that join, leave, fall silent, fall behind with
/// their leases, or die while they solve. One thread; `state` must outlive this object.
class Workers {
 public:
  using Time = Worker::Time;
  explicit Workers(ServiceState& state);

  WorkerRegistry registry;
  Leases leases;
  Allotment allotment;
  Crowd heard;             ///< keys and machines of the workers of this and earlier runs
  bool newcomers = false;  ///< a worker joined since the table of servers was written

  // Messages of workers. hello() returns true if the worker is the first one on a second machine.
  bool hello(const Incoming& incoming);
  void request(Worker& worker, const wire::Request& request);
  void heartbeat(Worker& worker, const wire::Heartbeat& heartbeat);
  void goodbye(const Worker& worker, const wire::Goodbye& goodbye);
  /// Counts a message that is dropped, and logs the first ones.
  void badMessage(const std::string& peer, const std::string& why);

  /// Scans all workers, but returns at once if the last scan was only just done. Hands out again
  /// the leases that a worker does not work on. Sends a message to workers that are silent, and
  /// removes workers that have been silent for too long. The cost grows with the number of workers.
  void sweep();
  /// Time when sweep() next has work.
  Time nextSweep() const { return std::max(silence_due_, look_round_at_); }
  /// Hands out the last target of a worker again, because the worker delivers nothing.
  void reassignLast(Worker& worker);
  /// Call when the scheduler itself did nothing for the time `gap`. The silence of workers in that
  /// time does not count.
  void forgiveGap(std::chrono::nanoseconds gap);

  /// Removes a worker that left without a message. Blames no transition yet: that is done if the
  /// worker's process turns out to have ended.
  void lose(const Worker& worker);
  void unreachable(const std::string& peer);
  /// Sets the kernel family to that of the first result. Workers with other kernels must say hello
  /// again. They are then told to use these kernels, or are refused with the reason.
  void settleKernels(const std::string& family);
  /// Tells all workers to leave.
  void drainAll();

  /// Queues transitions that are ready.
  void addReady(const std::vector<ResultKey>& keys);
  /// Lets set-aside transitions wait again.
  void retryAside();

  bool isOneMachine() const { return heard.machines.size() < 2; }
  /// Number of targets that a worker may be given in addition to its leases.
  std::size_t roomOf(const Worker& worker) const;
  /// True if the worker asks for work or holds leases, unless it is overdue and holds nothing.
  bool asksForWork(const Worker& worker) const;
  /// True if no worker has sent anything for three heartbeat intervals.
  bool deserted(Time now) const;

 private:
  void remove(const Worker& worker, const char* how);
  void reclaimFromIdle();
  void reassignOverdue();
  void probeSilent();
  void loseSilent();
  void processEnded(const std::string& worker_id);
  void blame(const Leases::Suspects& suspects);

  ServiceState& state_;
  std::string epoch_;                                    ///< random, identifies this run
  std::map<Tables::NumberedTransition, Losses> losses_;  ///< from earlier runs
  /// Workers that were lost and did not come back, the latest last. If their processes turn out to
  /// have ended, their suspects are blamed.
  std::deque<std::pair<std::string, Leases::Suspects>> departed_;
  Time look_round_at_{};  ///< earliest time of the next scan
  /// earliest time at which a worker may have been silent for too long
  Time silence_due_ = Time::max();
};

}  // namespace palpate
