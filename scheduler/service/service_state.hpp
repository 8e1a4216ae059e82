#pragma once

#include <memory>

#include "scheduler/service/allotment.hpp"
#include "scheduler/service/chronicle.hpp"
#include "scheduler/service/spot_checks.hpp"
#include "scheduler/state/result_group.hpp"

namespace palpate {

/// A message on its way to a peer. Several messages may share one payload.
struct Outgoing {
  std::string peer;
  wire::Message message;
  std::shared_ptr<const std::string> payload;  ///< may be null
};

struct CoordinatorSettings {
  /// Interval of the workers' heartbeats. Cheap. A heartbeat also names the target in work, in case
  /// its solve kills the worker.
  std::chrono::milliseconds heartbeat{1000};
  /// Silence after which a worker's leases are handed out again. If it is shorter than network
  /// outages, work is done twice.
  std::chrono::milliseconds worker_lost{60000};
  /// Heartbeats of silence after which a worker is sent a message: a broken connection shows only
  /// when something is sent.
  int silent_heartbeats = 3;
  /// A scheduler that did nothing for this long was stopped, or had no processor time. The messages
  /// of its workers lie unread, so silence in that time does not count.
  std::chrono::milliseconds own_gap{3000};
  /// A worker whose heartbeats report no solve for this long, although it holds leases, never got
  /// them or forgot them.
  std::chrono::milliseconds idle_with_leases{30000};
  AllotmentSettings allotment;
  /// A solve is hung if it takes hung_factor times the longest recorded one, and at least
  /// hung_at_least. Before the first result the limit is hung_without_any.
  double hung_factor = 30;
  std::chrono::seconds hung_at_least{120}, hung_without_any{3600};
  std::optional<std::chrono::seconds> hung_after;  ///< replaces these limits
  /// Group commit. Results wait for others at most group_age, or group_age_all_read if nothing more
  /// is to be read. They wait less while a worker waits for work that they may make ready. At most
  /// group_results of at most group_bytes share one sync.
  std::chrono::milliseconds group_age{20}, group_age_all_read{5};
  std::size_t group_results = 256, group_bytes = std::size_t{16} << 20;
  /// Bytes of start configurations that may lie unread with workers. Beyond this limit no request
  /// is answered, and workers ask again.
  std::size_t unread_starts = std::size_t{96} << 20;
  SpotCheckSettings spot_checks;
  /// Time that checks wait, when all else is done, for another machine that was here to come back.
  std::chrono::milliseconds checks_wait{15000};
  /// Keys identify people and machines, and not just this run.
  bool keys_tell_who = true;
  /// Kernel family that computes all results (arithmeticOf). If empty, the first result decides. In
  /// a build with results, their kernel family counts instead.
  std::string kernel_family;
  /// Receives the events; null: there are none. Must outlive the coordinator.
  EventLog* events = nullptr;
};

/// The state that the parts of a coordinator share: the build with its records and plans, the
/// messages to be sent, the reports, and the decisions. The referenced objects must outlive it. One
/// thread.
struct ServiceState {
  using Time = std::chrono::steady_clock::time_point;

  const Problem& problem;
  JobStore& store;
  const CoordinatorSettings settings;
  Time now;  ///< time of the current message or turn

  const Time started = now;
  Tables& tables = store.tables();
  std::vector<SpacePlan> plans = {};  ///< one per active node
  ResultGroup group = ResultGroup(store);
  Counters counters = tables.counters();
  std::vector<Outgoing> outbox = {};
  Chronicle chronicle = Chronicle(problem, settings.events, now);

  bool stopping = false, paused = tables.paused(), complete = false, dismissed = false;
  std::vector<KeptOut> liars = {};  ///< once there are any, another Build begins
  /// Turns since recorded failures were dropped. In the second turn the answer has been sent.
  std::optional<int> turns_since_retry = std::nullopt;

  bool handsOut() const { return !stopping && !paused && !complete; }
  /// True if all workers were told to leave. A worker that is then gone does not count as lost.
  bool everybodyIsToLeave() const { return stopping || dismissed; }

  wire::Message& send(const std::string& peer,
                      std::shared_ptr<const std::string> payload = nullptr);
  /// Sends an acknowledgement, which says that the result is recorded unless the caller adds to it.
  wire::ResultAck& acknowledge(const std::string& peer, const wire::Result& result);
  /// Tells a worker to leave.
  void drain(const std::string& peer) { send(peer).mutable_drain()->set_finished(complete); }
};

}  // namespace palpate
