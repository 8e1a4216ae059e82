#pragma once

#include <deque>
#include <memory>

#include "common/wire/connections.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/plan/forecast.hpp"
#include "scheduler/plan/leases.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/service/allotment.hpp"
#include "scheduler/service/chronicle.hpp"
#include "scheduler/service/lease_seal.hpp"
#include "scheduler/service/peer_log.hpp"
#include "scheduler/service/result_check.hpp"
#include "scheduler/service/spot_checks.hpp"
#include "scheduler/service/status.hpp"
#include "scheduler/service/unread_payloads.hpp"
#include "scheduler/service/worker_registry.hpp"
#include "scheduler/state/result_group.hpp"

namespace palpate {

/// A message on its way to a peer. The payload may be shared by many.
struct Outgoing {
  std::string peer;
  wire::Message message;
  std::shared_ptr<const std::string> payload;  ///< may be null
};

struct CoordinatorSettings {
  /// How often workers say that they live. Cheap; it also names the target whose solve would kill a
  /// worker.
  std::chrono::milliseconds heartbeat{1000};
  /// What a worker that says nothing for so long holds is handed out again. Shorter than network
  /// outages costs work done twice.
  std::chrono::milliseconds worker_lost{60000};
  /// A worker that is silent for so many heartbeats is sent something, since a connection that
  /// broke shows when something is sent.
  int silent_heartbeats = 3;
  /// A scheduler that does nothing for so long was stopped, or had no time: what its workers said
  /// meanwhile lies unread, and no silence of that time counts.
  std::chrono::milliseconds own_gap{3000};
  /// A worker that says it solves nothing while it holds leases for so long never got them, or
  /// forgot them.
  std::chrono::milliseconds idle_with_leases{30000};
  AllotmentSettings allotment;
  /// A solve that takes so many times the longest one recorded is hung; and not before it took
  /// hung_at_least, or hung_without_any when nothing is recorded yet.
  double hung_factor = 30;
  std::chrono::seconds hung_at_least{120}, hung_without_any{3600};
  std::optional<std::chrono::seconds> hung_after;  ///< instead of all that
  /// Group commit: results wait for others at most so long, and at most so many, of so many bytes,
  /// share one sync. Where there is nothing more to read, who waits for what they make ready is
  /// served sooner.
  std::chrono::milliseconds group_age{20}, group_age_all_read{5};
  std::size_t group_results = 256, group_bytes = std::size_t{16} << 20;
  /// Bytes of start configurations that lie unread with workers; beyond it none is answered, and
  /// workers ask again.
  std::size_t unread_starts = std::size_t{96} << 20;
  SpotCheckSettings spot_checks;
  /// When all else is done, checks wait so long for another machine that was here to come back.
  std::chrono::milliseconds checks_wait{15000};
  /// Keys are those of people and machines, and not of this run alone.
  bool keys_tell_who = true;
  /// With which all results are computed (arithmeticOf); empty: those of the first result decide.
  /// Where something is recorded, its own.
  std::string kernel_family;
  /// Who is told what happens; null: nobody. Must outlive the coordinator.
  EventLog* events = nullptr;
};

/// How it goes on after a turn of a coordinator.
enum class Next : std::uint8_t {
  go_on,
  stop,      ///< somebody asked for it
  complete,  ///< every space is complete and recorded
  stuck,     ///< Coordinator::stuck()
  /// Recorded results are to be computed again: somebody wants failures tried again, or they are
  /// those of Coordinator::liars(). Another Build goes on in the directory (Build::keepOut).
  anew,
};

/// What every message means: takes messages and the time, keeps plans, leases, registry and the
/// group of results in step, and leaves messages to be sent. No sockets, no clock of its own, one
/// thread.
///
/// A result is acknowledged after ResultGroup::commit (docs/state.md). Only then does the plan move
/// on. Construction replays what is recorded, so a restart goes on where the last run was.
///
/// Some results are solved again by other machines (SpotChecks), as soon as there are two. Plans do
/// not wait for that, only the end of the build does.
///
/// Errors of journal or tables leave as exceptions, and DamagedRecord where a result that is needed
/// cannot be read any more. After one, and after Next::anew, the object must not be used, and
/// nothing was acknowledged that is not on disk.
class Coordinator {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// All references must outlive this object. `problem_bytes` is encodeProblem(problem).
  Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store, Time now,
              const CoordinatorSettings& settings = {});

  void receive(const Incoming& incoming, Time now);
  /// A message whose sender may not say it: is told why, and if it was a worker, it is none any
  /// more.
  void refuse(const Incoming& incoming, Time now);
  /// Whatever time brings: commits a group that is due, takes back what silent workers hold, hands
  /// out jobs. Call after every batch of messages and at nextDeadline. `all_read`: no message waits
  /// that would show that a silent worker is not silent. Returns next().
  Next advance(Time now, bool all_read = true);
  /// What the messages so far, and the last turn, lead to.
  Next next() const;
  /// Everything to be sent, in order.
  std::vector<Outgoing> takeOutbox() {
    large_answers_.clear();
    return std::exchange(outbox_, {});
  }
  /// advance() has something to do then.
  Time nextDeadline() const;

  /// A message could not be delivered: the peer is gone, or reads nothing.
  void peerUnreachable(const std::string& peer, Time now);
  /// Connections were closed because they cost too much.
  void noteClosed(const Connections::Closed& closed, Time now);
  /// The local process `pid` ended by itself: what it was solving may have killed it.
  void workerProcessEnded(std::uint32_t pid, Time now);

  /// No more hand-outs; workers are told to leave. Commits what is there.
  void stop(Time now);
  bool stopping() const { return stopping_; }
  /// Whether nothing is handed out, before it is told to go on: in this run and the next ones.
  /// Workers finish what they hold, and stay.
  void pause(bool paused);
  bool paused() const { return paused_; }
  /// Every space is complete and recorded.
  bool complete() const { return complete_; }
  /// All is recorded but transitions that are set aside, because workers died on them, and disputed
  /// ones for which there is no other worker to ask.
  bool stuck() const {
    return !complete_ && group_.size() == 0 && leases_.stuck() &&
           (leases_.waitingChecks().empty() || checks_hopeless_);
  }
  /// Whoever was found to give wrong results: Build::keepOut() comes before another Build.
  const std::vector<KeptOut>& liars() const { return liars_; }
  std::size_t asideCount() const { return leases_.aside().size(); }
  /// Whether another worker is asked for what is recorded, or is to be.
  bool isChecked(const ResultKey& key) const {
    return checks_.isOpen(key) || due_checks_.contains(key);
  }
  /// Results that two workers found differently.
  std::size_t disputedCount() const { return checks_.disputedCount(); }
  /// The dataset can do without workers: they are told to leave.
  void dismiss();
  /// Workers that said hello and neither left nor were lost.
  std::size_t workers() const { return registry_.all().size(); }
  /// No worker said anything for three heartbeats: after Drain they have all left.
  bool deserted(Time now) const;
  /// Results that earlier runs left.
  std::size_t found() const { return found_; }
  /// Results recorded since construction.
  std::int64_t recorded() const { return recorded_; }

  /// What people are told (docs/commands.md).
  wire::Status status(Time now) const;
  /// One per active node.
  const std::vector<SpacePlan>& plans() const { return plans_; }

 private:
  /// What people ask; false: it is none of that.
  bool answer(const Incoming& incoming, Time now);

  // Messages of workers.
  void hello(const Incoming& incoming, Time now);
  void request(Worker& worker, const wire::Request& request);
  void sendProblem(const Worker& worker);
  void sendFields(const Worker& worker, const wire::FieldsRequest& request);
  void result(Worker& worker, const Incoming& incoming, Time now);
  void heartbeat(Worker& worker, const wire::Heartbeat& heartbeat, Time now);
  void goodbye(Worker& worker, const wire::Goodbye& goodbye, Time now);
  void badMessage(const std::string& peer, const std::string& why);

  // From a result to the plan.
  void take(Worker& worker, const TransitionKey& key, const Incoming& incoming, Time now);
  void unwanted(const Worker& worker, const wire::Result& result);
  SpotChecks::Look lookOf(const TransitionKey& key, const Outcome& outcome) const;
  void settleKernels(const std::string& family, Time now);
  bool duplicate(const Worker& worker, const wire::Result& first, const wire::Result& second,
                 Time now);
  bool groupIsDue(Time now, bool all_read);
  void commitGroup(Time now);
  void finishIfComplete(Time now);

  // What other workers solve again (coordinator_checks.cpp).
  void noteCheck(const ResultKey& key, bool disputed);
  void openChecks();
  bool openCheck(const ResultKey& key, bool disputed);
  void forgetChecksOfNothing();
  bool isRecordedInPlan(const ResultKey& key) const;
  void compare(Worker& worker, const TransitionKey& key, const wire::Result& first,
               const wire::Result& second, Time now);
  void differs(const Worker& worker, const wire::Result& first, const wire::Result& second,
               Time now);
  void contradict(const Worker& worker, const wire::Result& result);
  void conclude(const ResultKey& key, const SpotChecks::Verdict& verdict);
  void findLiars(const SpotChecks::Verdict& verdict, const std::string& reason);
  bool isOneMachine() const { return heard_.machines.size() < 2; }
  bool othersMayCome() const;
  std::map<TransitionKey, Apart> wantedOfChecks() const;
  bool mayCheck(const TransitionKey& key, const Worker& worker, Apart wanted) const;
  void giveUpChecks(Time now);
  bool asksForWork(const Worker& worker) const;
  bool isHopeless(const TransitionKey& check, Apart wanted) const;
  void giveUp(const TransitionKey& check);

  // From the plan to workers.
  bool handsOut() const { return !stopping_ && !paused_ && !complete_; }
  void handOutJobs(Time now);
  std::size_t roomOf(const Worker& worker) const;
  void lookRound(Time now);
  void takeBackForTheIdle(Time now);
  void takeBackLast(Worker& worker, Time now);
  void sendJob(const Worker& worker, const Handout& handout);
  void takeBackFromTheIdle(Time now);
  void noteOwnGap(Time now);
  void probeSilentWorkers(Time now);
  void loseSilentWorkers(Time now);
  /// Who was told to leave, and is gone, is not lost.
  bool everybodyIsToLeave() const { return stopping_ || dismissed_; }
  void lose(const Worker& worker, Time now);
  void processEnded(const std::string& worker_id, Time now);
  void blame(const Leases::Suspects& suspects);
  std::chrono::seconds hungAfter() const;
  void add(const Settled& settled);
  void lookAhead(Time now);
  void addTimeLeft(wire::Status& status, Time now) const;
  std::int32_t retry();
  std::int32_t retryFailed(const std::string& cause);
  std::string prioritize(const std::string& name, std::int32_t priority);

  const std::string& recentStatus(Time now);
  Time serversDue() const;
  void writeServers(Time now);
  void writeProgress(Time now);
  wire::Message& send(const std::string& peer,
                      std::shared_ptr<const std::string> payload = nullptr);
  /// Says that the result is recorded, unless more is said.
  wire::ResultAck& acknowledgement(const std::string& peer, const wire::Result& result);
  void drain(const std::string& peer);
  void drainAll();

  const Problem* problem_;
  std::shared_ptr<const std::string> problem_bytes_;
  ContentId build_;
  ResultCheck check_;
  LeaseSeal seal_;
  SpotChecks checks_;
  JobStore* store_;
  CoordinatorSettings settings_;
  std::string incarnation_;  ///< 16 random bytes

  std::vector<SpacePlan> plans_;
  SpareResults spare_;  ///< recorded, and not asked for yet (Replay)
  Leases leases_;
  std::map<TransitionKey, Losses> losses_;  ///< of earlier runs
  /// To be opened, as soon as they are recorded and there is room; whether they are disputed.
  std::map<ResultKey, bool> due_checks_;
  Crowd heard_;  ///< workers of this run, and those whose results are recorded
  WorkerRegistry registry_;
  Allotment allotment_;
  /// Of workers that went without a word and did not come back, the latest last: their processes
  /// may prove to have ended.
  std::deque<std::pair<std::string, Leases::Suspects>> departed_;
  ResultGroup group_;
  std::vector<Outgoing> outbox_;
  std::map<std::string, int> large_answers_;  ///< in it, by peer
  UnreadPayloads unread_starts_;

  Counters counters_;
  Time started_;
  Time last_turn_;
  Time look_round_at_;              ///< not before, at all workers
  Time silence_due_ = Time::max();  ///< one of them has been silent for too long then, or later
  Time servers_written_, progress_written_;
  bool newcomers_ = false;     ///< since then
  std::string recent_status_;  ///< JSON
  Time recent_status_made_;
  PeerLog peer_log_;
  Chronicle chronicle_;
  Pace pace_;       ///< of equilibria
  Pace work_pace_;  ///< of results, whatever they say
  Forecast forecast_;
  Time forecast_made_;
  std::int64_t recorded_then_ = 0;
  std::size_t found_ = 0;
  std::map<std::string, std::int32_t> priorities_;  ///< by row of a status
  std::vector<KeptOut> liars_;
  /// Since recorded failures were dropped. In the second one the answer has left.
  std::optional<int> turns_since_retry_;
  std::int64_t converged_ = 0;  ///< of recorded_
  std::int64_t recorded_ = 0;
  double longest_solve_ = 0;  ///< s, of all results; 0 before the first
  bool stopping_ = false, paused_ = false, complete_ = false, dismissed_ = false;
  std::optional<Time> only_checks_left_;  ///< since then
  bool checks_hopeless_ = false;          ///< nobody came who could do them
};

}  // namespace palpate
