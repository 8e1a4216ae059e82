#pragma once

#include <memory>

#include "common/base/assertion.hpp"
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
  /// Interval of the workers' heartbeats, which cost little. A heartbeat also names the target that
  /// the worker is solving, in case the solve kills the worker.
  std::chrono::milliseconds heartbeat{1000};
  /// Time of silence after which a worker's leases are handed out again. If network outages last
  /// longer, work is done twice.
  std::chrono::milliseconds worker_lost{60000};
  /// Number of missed heartbeats after which a silent worker is sent a message, because a broken
  /// connection is noticed only when something is sent.
  int silent_heartbeats = 3;
  /// A scheduler that did nothing for this long was stopped, or had no processor time. Messages of
  /// its workers may then lie unread, so their silence in that time does not count.
  std::chrono::milliseconds own_gap{3000};
  /// If a worker holds leases but its heartbeats report no solve for this long, it never received
  /// the leases or has forgotten them.
  std::chrono::milliseconds idle_with_leases{30000};
  AllotmentSettings allotment;
  /// A solve is hung if it takes hung_factor times the longest recorded one, and at least
  /// hung_at_least. Before the first result the limit is hung_without_any.
  double hung_factor = 30;
  std::chrono::seconds hung_at_least{120}, hung_without_any{3600};
  std::optional<std::chrono::seconds> hung_after;  ///< if set, used instead of these limits
  /// Group commit: results wait for others, so that one sync covers many. They wait at most
  /// group_age, or at most group_age_all_read once no received message is left unread. They do not
  /// wait if a worker waits for work that they may make ready. A group is also committed when it
  /// has group_results results or group_bytes of payload.
  std::chrono::milliseconds group_age{20}, group_age_all_read{5};
  std::size_t group_results = 256, group_bytes = std::size_t{16} << 20;
  /// Limit on the bytes of start configurations that were sent to workers but not read yet. Beyond
  /// this limit, requests for start configurations are not answered; the workers ask again.
  std::size_t unread_starts = std::size_t{96} << 20;
  SpotCheckSettings spot_checks;
  /// When only spot checks are left, the scheduler waits this long for machines that worked on this
  /// build before to connect again.
  std::chrono::milliseconds checks_wait{15000};
  /// True if keys identify people and machines; false if they were made for this run only.
  bool keys_tell_who = true;
  /// Kernel family that computes all results (arithmeticOf). If empty, the first result decides. If
  /// the build already has results, their kernel family is used instead.
  std::string kernel_family;
  /// Log that receives the events; may be null. Must outlive the coordinator.
  EventLog* events = nullptr;
};

/// The state that the parts of a coordinator share: the build with its records and plans, outgoing
/// messages, reports, and flags such as `stopping`. The referenced objects must outlive this one.
/// One thread.
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
  /// Workers to exclude. If not empty, a new Build replays the journal without their results.
  std::vector<KeptOut> liars = {};
  /// Number of turns since an operator's retry dropped recorded failures; none without a retry. By
  /// the second turn, the answer to the operator has been sent.
  std::optional<int> turns_since_retry = std::nullopt;

  bool handsOut() const { return !stopping && !paused && !complete; }
  /// True if all workers were told to leave. A worker that disappears after that does not count as
  /// lost.
  bool everybodyIsToLeave() const { return stopping || dismissed; }

  wire::Message& send(const std::string& peer,
                      std::shared_ptr<const std::string> payload = nullptr) {
    outbox.push_back({peer, {}, std::move(payload)});
    return outbox.back().message;
  }
  /// Sends and returns an acknowledgement. It says that the result is recorded, unless the caller
  /// sets `unwanted` in it.
  wire::ResultAck& acknowledge(const std::string& peer, const wire::Result& result) {
    PALPATE_ASSERT(!turns_since_retry, "plans with dropped results must not take new results");
    wire::ResultAck& ack = *send(peer).mutable_result_ack();
    ack.set_space(result.space());
    *ack.mutable_target() = result.target();
    *ack.mutable_parent() = result.parent();
    return ack;
  }
  /// Tells a worker to leave.
  void drain(const std::string& peer) { send(peer).mutable_drain()->set_finished(complete); }
};

}  // namespace palpate
