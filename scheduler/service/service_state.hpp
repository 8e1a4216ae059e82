#pragma once

#include <memory>

#include "scheduler/service/allotment.hpp"
#include "scheduler/service/chronicle.hpp"
#include "scheduler/service/spot_checks.hpp"
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

/// What the parts of a coordinator share: the build, as it is recorded and planned, what is to be
/// sent, what is told of it, and what was decided. What the first members refer to must outlive it.
/// One thread.
struct ServiceState {
  using Time = std::chrono::steady_clock::time_point;

  const Problem& problem;
  JobStore& store;
  const CoordinatorSettings settings;
  Time now;  ///< of the message or the turn that is dealt with

  const Time started = now;
  Tables& tables = store.tables();
  std::vector<SpacePlan> plans = {};  ///< one per active node
  ResultGroup group = ResultGroup(store);
  Counters counters = tables.counters();
  std::vector<Outgoing> outbox = {};
  Chronicle chronicle = Chronicle(problem, settings.events, now);

  bool stopping = false, paused = tables.paused(), complete = false, dismissed = false;
  std::vector<KeptOut> liars = {};  ///< with any, another Build begins anew
  /// Since recorded failures were dropped. In the second one the answer has left.
  std::optional<int> turns_since_retry = std::nullopt;

  bool handsOut() const { return !stopping && !paused && !complete; }
  /// Who was told to leave, and is gone, is not lost.
  bool everybodyIsToLeave() const { return stopping || dismissed; }

  wire::Message& send(const std::string& peer,
                      std::shared_ptr<const std::string> payload = nullptr);
  /// Says that the result is recorded, unless more is said.
  wire::ResultAck& acknowledge(const std::string& peer, const wire::Result& result);
  /// Tells a worker to leave.
  void drain(const std::string& peer) { send(peer).mutable_drain()->set_finished(complete); }
};

}  // namespace palpate
