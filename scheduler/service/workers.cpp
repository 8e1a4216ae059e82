#include "scheduler/service/workers.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/bytes32.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

/// Number of bad messages that are logged. In a flood, the first ones show the problem.
constexpr std::int64_t bad_messages_logged = 20;
/// Limit on the size of departed_.
constexpr std::size_t most_departed = 4096;
/// Limit on the number of ended workers that one Hello may name. A supervisor names one.
constexpr int most_ended = 64;
/// Interval of the scans of all workers. A scan costs 0.33 us per worker, which at this interval is
/// 5 % of a core.
constexpr std::chrono::microseconds looked_at_every{6};  // times the number of workers

}  // namespace

Workers::Workers(ServiceState& state)
    : registry(state.store.kernelFamily().empty() ? state.settings.kernel_family
                                                  : state.store.kernelFamily(),
               state.store.keptOut()),
      // The upper half of a job number identifies the run, so no two runs use the same numbers.
      leases(static_cast<std::uint64_t>(++state.counters["runs"]) << 32),
      allotment(state.settings.allotment),
      state_(state),
      epoch_(randomBytes(16)),
      losses_(state.tables.losses()) {
  // The workers of earlier runs may come back at any moment, so their machines are included.
  for (const auto& [key, host] : state.store.machines()) heard.add(key, host);
}

bool Workers::hello(const Incoming& incoming) {
  const std::string& peer = incoming.peer;
  const wire::Hello& hello = incoming.message.hello();
  const auto key = state_.settings.keys_tell_who ? incoming.key : std::nullopt;
  if (const std::string objection = registry.objectionTo(hello, key); !objection.empty()) {
    state_.chronicle.refused(printable(hello.host()), hello.pid(), objection);
    ++state_.counters["refused_workers"];
    state_.send(peer).mutable_refused()->set_reason(objection);
    return false;
  }
  if (registry.wouldChangeKernels(hello)) {
    state_.chronicle.info("worker {} on {} is asked to use the {} kernels instead of {}",
                          hello.pid(), printable(hello.host()), registry.kernelFamily(),
                          hello.kernel_family());
    state_.send(peer).mutable_use_kernels()->set_kernel_family(registry.kernelFamily());
    return false;
  }
  for (int n = 0; n < std::min(hello.ended_size(), most_ended); ++n) processEnded(hello.ended(n));
  if (const Worker* before = registry.ofPeer(peer); before && before->id != hello.worker())
    remove(*before, "left");
  // A worker that says hello again has forgotten its leases: hand them out again.
  leases.giveBack(hello.worker());
  // The worker is alive, so the leases that it had when it was lost did not kill it.
  std::erase_if(departed_, [&](const auto& entry) { return entry.first == hello.worker(); });
  const Worker& worker = registry.admit(peer, hello, key, state_.now);
  silence_due_ = std::min(silence_due_, state_.now + state_.settings.worker_lost);
  state_.chronicle.joined(worker);
  newcomers = true;
  const bool was_one_machine = isOneMachine();
  heard.add(worker.provenance.key(), worker.provenance.host());

  wire::Welcome& welcome = *state_.send(peer).mutable_welcome();
  welcome.set_epoch(epoch_);
  welcome.set_build(std::string(state_.store.build().bytes()));
  welcome.set_heartbeat_ms(static_cast<std::uint32_t>(state_.settings.heartbeat.count()));
  if (state_.everybodyIsToLeave()) state_.drain(peer);
  return was_one_machine && !isOneMachine();
}

void Workers::request(Worker& worker, const wire::Request& request) {
  // The worker may have missed the first Drain.
  if (state_.everybodyIsToLeave()) return state_.drain(worker.peer);
  if (request.afresh()) worker.credit = 0;
  registry.addCredit(worker, request.credit());
}

void Workers::goodbye(const Worker& worker, const wire::Goodbye& goodbye) {
  state_.chronicle.left(worker, printable(goodbye.reason(), 200));
  remove(worker, "left");
}

void Workers::heartbeat(Worker& worker, const wire::Heartbeat& heartbeat) {
  worker.solving.reset();
  if (heartbeat.solving()) {
    worker.idle_since.reset();
    for (const ResultKey& key : leases.openOf(worker.id, heartbeat.job()))
      if (key.target == fromWire(heartbeat.target())) worker.solving = key;
  } else if (leases.leasedTo(worker.id) > 0 && !worker.idle_since) {
    worker.idle_since = state_.now;
    silence_due_ = std::min(silence_due_, state_.now + state_.settings.idle_with_leases);
  }
  state_.send(worker.peer).mutable_heartbeat_reply()->set_epoch(epoch_);
  if (state_.everybodyIsToLeave()) state_.drain(worker.peer);
}

void Workers::settleKernels(const std::string& family) {
  registry.setKernelFamily(family);
  std::vector<const Worker*> others;
  for (const auto& [id, worker] : registry.all())
    if (worker.kernel_family != family) others.push_back(&worker);
  for (const Worker* worker : others) {
    state_.send(worker->peer).mutable_heartbeat_reply();
    remove(*worker, "left");
  }
}

bool Workers::deserted(Time now) const {
  // Once the build is complete, workers that were told to leave may do so without a message.
  return std::ranges::all_of(registry.all(), [&](const auto& entry) {
    return now - entry.second.heard > 3 * state_.settings.heartbeat;
  });
}

void Workers::forgiveGap(std::chrono::nanoseconds gap) {
  for (auto& [id, worker] : registry.all()) {
    worker.heard += gap;
    if (worker.idle_since) *worker.idle_since += gap;
    if (worker.probed) *worker.probed += gap;
    worker.moved += gap;
  }
}

std::size_t Workers::roomOf(const Worker& worker) const {
  const std::size_t most = allotment.limitOf(worker, state_.now);
  return most - std::min(most, leases.leasedTo(worker.id));
}

bool Workers::asksForWork(const Worker& worker) const {
  const std::size_t held = leases.leasedTo(worker.id);
  return held + roomOf(worker) > 0 && (worker.credit > 0 || held > 0);
}

/// If no transition waits, hands out the last targets of overdue workers again, at most one per
/// idle worker. An idle worker without results is counted only if no worker has delivered a result
/// (Worker::earned). As always, the first result of a target is recorded.
void Workers::reassignOverdue() {
  if (!state_.handsOut() || leases.waiting() > 0) return;
  const bool all_are_new = std::ranges::none_of(
      registry.all(), [](const auto& entry) { return entry.second.earned > 0; });
  int idle = 0;
  registry.eachAsking([&](const Worker& worker) {
    idle +=
        (worker.earned > 0 || all_are_new) && leases.leasedTo(worker.id) == 0 && roomOf(worker) > 0;
    return true;
  });
  for (auto& [id, worker] : registry.all()) {
    if (idle == 0) return;
    const auto last = leases.lastOf(id);
    // SecondSolves reassigns overdue checks.
    if (!last || last->is_check || !allotment.isOverdue(worker, last->attempts, state_.now))
      continue;
    reassignLast(worker);
    --idle;
  }
}

void Workers::reassignLast(Worker& worker) {
  if (!worker.overdue_until)
    state_.chronicle.info("worker {} on {} is overdue; its last solve goes to another worker",
                          worker.pid, worker.provenance.host());
  ++state_.counters["overdue_targets"];
  leases.giveBackLast(worker.id);
  allotment.noteOverdue(worker, state_.now);
}

void Workers::sweep() {
  if (state_.now < look_round_at_) return;
  reclaimFromIdle();
  reassignOverdue();
  probeSilent();
  loseSilent();
  look_round_at_ = state_.now + looked_at_every * registry.all().size();
  silence_due_ = Time::max();
  for (const auto& [id, worker] : registry.all()) {
    silence_due_ = std::min(silence_due_, worker.heard + state_.settings.worker_lost);
    if (worker.idle_since)
      silence_due_ = std::min(silence_due_, *worker.idle_since + state_.settings.idle_with_leases);
  }
}

void Workers::reclaimFromIdle() {
  for (auto& [id, worker] : registry.all()) {
    if (!worker.idle_since || state_.now - *worker.idle_since < state_.settings.idle_with_leases)
      continue;
    state_.chronicle.warn(
        "worker {} on {} has leases, but its heartbeats report no solve; other workers get its "
        "targets",
        worker.pid, worker.provenance.host());
    registry.addCredit(worker, leases.jobsOf(id).size());
    worker.idle_since.reset();
    leases.giveBack(id);
  }
}

void Workers::loseSilent() {
  // Collect the workers first, because the registry must not change during the iteration.
  std::vector<const Worker*> silent;
  for (const auto& [id, worker] : registry.all())
    if (state_.now - worker.heard >= state_.settings.worker_lost) silent.push_back(&worker);
  for (const Worker* worker : silent) {
    state_.chronicle.lost(*worker, "silent", leases.leasedTo(worker->id));
    lose(*worker);
  }
}

void Workers::probeSilent() {
  const auto patience = state_.settings.silent_heartbeats * state_.settings.heartbeat;
  for (auto& [id, worker] : registry.all()) {
    // A worker without leases is included if it was overdue and its leases went to other workers.
    const bool at_work = leases.leasedTo(id) > 0 || worker.overdue_until;
    if (state_.now - worker.heard < patience || !at_work) continue;
    if (worker.probed && state_.now - *worker.probed < state_.settings.heartbeat) continue;
    worker.probed = state_.now;
    state_.send(worker.peer).mutable_heartbeat_reply()->set_epoch(epoch_);
  }
}

void Workers::lose(const Worker& worker) {
  departed_.emplace_back(worker.id, leases.suspectsOf(worker.id, worker.solving));
  if (departed_.size() > most_departed) departed_.pop_front();
  if (!state_.everybodyIsToLeave()) ++state_.counters["lost_workers"];
  remove(worker, state_.everybodyIsToLeave() ? "left" : "lost");
}

void Workers::remove(const Worker& worker, const char* how) {
  leases.giveBack(worker.id);
  registry.remove(worker, how, state_.now);
}

void Workers::unreachable(const std::string& peer) {
  const Worker* worker = registry.ofPeer(peer);
  if (worker == nullptr) return;
  // The worker has probably left as it was told. Its goodbye may still lie unread.
  if (state_.everybodyIsToLeave() && leases.leasedTo(worker->id) == 0) {
    state_.chronicle.left(*worker, "it was told to leave");
    return lose(*worker);
  }
  state_.chronicle.lost(*worker, "unreachable", leases.leasedTo(worker->id));
  lose(*worker);
}

void Workers::processEnded(const std::string& worker_id) {
  if (const Worker* worker = registry.find(worker_id)) {
    state_.chronicle.ended(*worker, leases.leasedTo(worker_id));
    lose(*worker);
  }
  const auto departed =
      std::ranges::find(departed_, worker_id, [](const auto& entry) { return entry.first; });
  // Nothing to blame: the worker said goodbye, or only an earlier run of this scheduler knew it.
  if (departed == departed_.end()) return;
  blame(departed->second);
  departed_.erase(departed);
}

void Workers::blame(const Leases::Suspects& suspects) {
  for (const auto& [key, losses] : leases.blame(suspects)) {
    const std::optional<Transition> transition = findIn(state_.plans, key);
    PALPATE_ASSERT(transition, "a transition must join points of its plan");
    state_.tables.writeLosses({key.space, *transition}, losses);
    if (losses.deaths == deaths_before_aside) state_.chronicle.setAside(key, losses.deaths);
  }
}

void Workers::drainAll() {
  for (const auto& [id, worker] : registry.all()) state_.drain(worker.peer);
}

void Workers::addReady(const std::vector<ResultKey>& keys) {
  for (const ResultKey& key : keys) {
    const std::optional<Transition> transition = findIn(state_.plans, key);
    PALPATE_ASSERT(transition && state_.plans[key.space].isOpen(*transition),
                   "only requested transitions may be leased");
    const auto known = losses_.find({key.space, *transition});
    leases.add(key, known == losses_.end() ? Losses() : known->second);
  }
}

void Workers::retryAside() {
  leases.retry();
  losses_.clear();
  state_.tables.forgetLosses();
}

void Workers::badMessage(const std::string& peer, const std::string& why) {
  if (++state_.counters["bad_messages"] > bad_messages_logged) return;
  if (const Worker* worker = registry.ofPeer(peer))
    spdlog::warn("a message from worker {} on {} was dropped: {}", worker->pid,
                 worker->provenance.host(), why);
  else
    spdlog::warn("a message from an unknown peer was dropped: {}", why);
}

}  // namespace palpate
