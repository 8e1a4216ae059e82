#pragma once

#include <deque>

#include "common/wire/wire.hpp"
#include "scheduler/service/service_state.hpp"
#include "scheduler/service/worker_registry.hpp"

namespace palpate {

/// Who is there and what each has: workers come and go, fall silent, hold what others could do, and
/// end on what they solve. One thread; `state` must outlive it.
class Workers {
 public:
  using Time = Worker::Time;
  explicit Workers(ServiceState& state);

  WorkerRegistry registry;
  Leases leases;
  Allotment allotment;
  Crowd heard;             ///< workers of this run, and those whose results are recorded
  bool newcomers = false;  ///< since the table of servers was written

  // What they say. hello() returns whether a second machine came with it.
  bool hello(const Incoming& incoming);
  void request(Worker& worker, const wire::Request& request);
  void heartbeat(Worker& worker, const wire::Heartbeat& heartbeat);
  void goodbye(const Worker& worker, const wire::Goodbye& goodbye);
  /// A message is dropped, which the log tells.
  void badMessage(const std::string& peer, const std::string& why);

  /// A look at all of them, now and then: what they do not come to is handed out again, and who is
  /// silent is asked for a sign of life, and lost in the end. It costs the more, the more there
  /// are.
  void sweep();
  /// When it has something to do.
  Time nextSweep() const { return std::max(silence_due_, look_round_at_); }
  /// What a worker would come to last is handed out again, since it delivers nothing.
  void reassignLast(Worker& worker);
  /// The scheduler itself did nothing for so long: no silence of that time counts.
  void forgiveGap(std::chrono::nanoseconds gap);

  /// Gone without a word: nobody is to blame as long as its process is not known to have ended.
  void lose(const Worker& worker);
  void unreachable(const std::string& peer);
  void processEnded(std::uint32_t pid);
  /// The first result came with these kernels. Whoever has others is asked who it is again, and
  /// told then to take these, or why it may not stay.
  void settleKernels(const std::string& family);
  /// All are told to leave.
  void drainAll();

  /// Transitions that are to be solved now.
  void addReady(const std::vector<ResultKey>& keys);
  /// What is set aside waits again.
  void retryAside();

  bool isOneMachine() const { return heard.machines.size() < 2; }
  /// Targets that a worker may be given beside those that it holds.
  std::size_t roomOf(const Worker& worker) const;
  /// A worker asks for work, or does what it was given, as far as anybody knows.
  bool asksForWork(const Worker& worker) const;
  /// No worker said anything for three heartbeats.
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
  std::string epoch_;                                    ///< 16 random bytes
  std::map<Tables::NumberedTransition, Losses> losses_;  ///< of earlier runs
  /// Of workers that went without a word and did not come back, the latest last: their processes
  /// may prove to have ended.
  std::deque<std::pair<std::string, Leases::Suspects>> departed_;
  Time look_round_at_{};            ///< not before
  Time silence_due_ = Time::max();  ///< one of them has been silent for too long then, or later
};

}  // namespace palpate
