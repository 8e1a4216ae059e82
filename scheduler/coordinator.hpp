#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/problem/problem.hpp"
#include "common/wire/wire.hpp"
#include "scheduler/plan/leases.hpp"
#include "scheduler/plan/space_plan.hpp"
#include "scheduler/result_check.hpp"
#include "scheduler/state/job_store.hpp"
#include "scheduler/state/journal.hpp"

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
  /// A worker that says nothing for so long is taken for dead. Shorter than network outages costs
  /// work done twice.
  std::chrono::milliseconds worker_lost{60000};
  /// A worker that says it solves nothing while it holds leases for so long never got them, or
  /// forgot them.
  std::chrono::milliseconds idle_with_leases{30000};
  /// Group commit: results wait for others at most so long, and at most so many share one sync and
  /// one transaction.
  std::chrono::milliseconds group_age{20};
  std::size_t group_results = 64;
};

/// What every message means: takes messages and the time, keeps plans, leases, journal and tables
/// in step, and leaves messages to be sent. No sockets, no clock of its own, one thread.
///
/// A result is acknowledged after journal append, sync and transaction, in that order
/// (docs/state.md). Only then does the plan move on. Construction replays what is recorded, so a
/// restart goes on where the last run was.
///
/// Errors of journal or tables leave as exceptions; the object must not be used afterwards, and
/// nothing was acknowledged that is not on disk.
class Coordinator {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// All references must outlive this object. `problem_bytes` is encodeProblem(problem).
  Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store, Journal& journal,
              Time now, CoordinatorSettings settings = {});

  void receive(const Incoming& incoming, Time now);
  /// Whatever time brings: commits a group that is due, gives up silent workers, hands out jobs.
  /// Call after every batch of messages and at nextDeadline.
  void advance(Time now);
  /// Everything to be sent, in order.
  std::vector<Outgoing> takeOutbox();
  /// advance() has something to do then.
  Time nextDeadline() const;

  /// A message could not be delivered: the peer is gone, or reads nothing.
  void peerUnreachable(const std::string& peer, Time now);
  /// The local process `pid` ended by itself: what it was solving may have killed it.
  void workerProcessEnded(std::uint32_t pid, Time now);

  /// No more hand-outs; workers are told to leave. Commits what is there.
  void stop(Time now);
  bool stopping() const { return stopping_; }
  /// Every space is complete and recorded.
  bool complete() const;
  /// Workers that said hello and neither left nor were lost.
  std::size_t workers() const { return workers_.size(); }
  /// No worker said anything for three heartbeats: after Drain they have all left.
  bool deserted(Time now) const;
  /// Results that earlier runs left.
  std::size_t found() const { return found_; }
  /// Results recorded since construction.
  std::int64_t recorded() const { return recorded_; }

  wire::Status status(Time now) const;
  const std::vector<SpacePlan>& plans() const { return plans_; }

 private:
  struct Worker {
    std::string peer;
    std::string host;
    std::uint32_t pid = 0;
    std::string kernel_family;
    std::uint32_t credit = 0;
    Time heard;
    std::optional<TransitionKey> solving;  ///< as its last heartbeat said
    std::optional<Time> idle_since;        ///< its heartbeats say so, while it holds leases
    std::int64_t results = 0;
  };
  using Workers = std::map<std::string, Worker>;  ///< by the id in Hello
  struct Pending {
    StoredResult result;
    std::string payload;
    std::set<std::string> peers;  ///< to be acknowledged
  };

  /// Which transition these words name; nothing when the space or a point does not exist.
  std::optional<TransitionKey> keyOf(std::uint32_t space, const wire::Point& target,
                                     const wire::Point& parent) const;
  /// The recorded configuration of a point.
  std::optional<StoredResult> configuration(std::uint32_t space, std::int32_t point) const;
  void addReady(std::uint32_t space);
  void recordInPlan(const StoredResult& result);

  void hello(const std::string& peer, const wire::Hello& hello, Time now);
  void request(Worker& worker, const wire::Request& request);
  void sendProblem(const std::string& peer);
  void sendFields(const std::string& peer, const wire::FieldsRequest& request);
  void heartbeat(const std::string& id, Worker& worker, const wire::Heartbeat& heartbeat, Time now);
  void result(const std::string& peer, Worker& worker, const Incoming& incoming, Time now);
  void duplicate(const std::string& peer, const wire::Result& first, const wire::Result& second);
  void badMessage(const std::string& peer, const std::string& why);

  void enqueue(StoredResult result, std::string payload, const std::string& peer, Time now);
  bool groupIsDue(Time now) const;
  void commitGroup(Time now);
  void handOutJobs();
  void sendJob(const std::string& peer, const Handout& handout);
  void loseSilentWorkers(Time now);
  void workerDied(const std::string& id, Time now, const char* why);
  void removeWorker(Workers::iterator worker, const char* state, Time now);
  void giveUp(const TransitionKey& key, Time now);
  void finishIfComplete(Time now);
  void writeServers(Time now);
  void noteProgress(Time now);
  void drain(const std::string& peer);
  std::string startId(std::uint32_t space, std::int32_t parent, std::int32_t target);

  wire::Message& send(const std::string& peer,
                      std::shared_ptr<const std::string> payload = nullptr);
  void sayUnknown(const std::string& peer);
  void acknowledge(const std::string& peer, const wire::Result& result);
  Workers::iterator workerOf(const std::string& peer);
  ServerRow rowOf(const std::string& id, const Worker& worker, const char* state, Time now) const;

  const Problem* problem_;
  std::shared_ptr<const std::string> problem_bytes_;
  ContentId build_;
  ResultCheck check_;
  JobStore* store_;
  Journal* journal_;
  CoordinatorSettings settings_;
  std::string incarnation_;  ///< 16 random bytes

  std::vector<SpacePlan> plans_;  ///< one per space
  Leases leases_;
  Workers workers_;
  std::map<std::string, std::string> id_of_peer_;
  std::map<TransitionKey, Pending> group_;
  std::optional<Time> group_since_;
  std::vector<Outgoing> outbox_;

  std::string kernel_family_;
  std::map<std::string, std::int64_t> counters_;
  std::vector<ServerRow> departed_;  ///< since servers were last written
  Time started_;
  Time servers_written_;
  std::deque<std::pair<Time, std::int64_t>>
      progress_;  ///< (when, converged_ then) of the last two minutes
  std::size_t found_ = 0;
  std::int64_t converged_ = 0;
  std::int64_t recorded_ = 0;
  bool stopping_ = false;
};

}  // namespace palpate
