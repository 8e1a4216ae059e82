#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/text.hpp"
#include "scheduler/service/coordinator.hpp"

// Who is there: workers come and go, fall silent, hold what others could do, and end on what they
// solve.

namespace palpate {
namespace {

/// Of so many workers that went it is remembered what they had.
constexpr std::size_t most_departed = 4096;
/// Workers that ended, of one Hello: a supervisor tells of one.
constexpr int most_ended = 64;
/// A look at all costs a third of a microsecond for each: a twentieth of a processor.
constexpr std::chrono::microseconds looked_at_every{6};  // times workers

}  // namespace

void Coordinator::hello(const Incoming& incoming, Time now) {
  const std::string& peer = incoming.peer;
  const wire::Hello& hello = incoming.message.hello();
  const auto key = settings_.keys_tell_who ? incoming.key : std::nullopt;
  if (const std::string objection = registry_.objectionTo(hello, key); !objection.empty()) {
    peer_log_.warn(now, "worker {} on {} was refused: {}", hello.pid(), printable(hello.host()),
                   objection);
    chronicle_.refused(printable(hello.host()), hello.pid(), objection, now);
    ++counters_["refused_workers"];
    send(peer).mutable_refused()->set_reason(objection);
    return;
  }
  if (registry_.wouldChangeKernels(hello)) {
    peer_log_.info(now, "worker {} on {} is asked to take the {} kernels instead of {}",
                   hello.pid(), printable(hello.host()), registry_.kernelFamily(),
                   hello.kernel_family());
    send(peer).mutable_use_kernels()->set_kernel_family(registry_.kernelFamily());
    return;
  }
  for (int n = 0; n < std::min(hello.ended_size(), most_ended); ++n)
    processEnded(hello.ended(n), now);
  if (const Worker* before = registry_.ofPeer(peer); before && before->id != hello.worker()) {
    leases_.giveBack(before->id);
    registry_.remove(*before, "left", now);
  }
  // A worker that introduces itself again has forgotten what it was given.
  leases_.giveBack(hello.worker());
  // It lives: what it had when it was lost did not end it.
  std::erase_if(departed_, [&](const auto& entry) { return entry.first == hello.worker(); });
  const Worker& worker = registry_.admit(peer, hello, key, now);
  silence_due_ = std::min(silence_due_, now + settings_.worker_lost);
  peer_log_.info(now, "worker {} on {} joined ({} kernels)", worker.pid, worker.host,
                 worker.kernel_family);
  chronicle_.joined(worker, now);
  newcomers_ = true;
  const bool was_one_machine = isOneMachine();
  heard_.add(worker.provenance.key(), worker.provenance.host());
  if (was_one_machine) openChecks();

  wire::Welcome& welcome = *send(peer).mutable_welcome();
  welcome.set_incarnation(incarnation_);
  welcome.set_build(std::string(build_.bytes()));
  welcome.set_heartbeat_ms(static_cast<std::uint32_t>(settings_.heartbeat.count()));
  if (everybodyIsToLeave()) drain(peer);
}

void Coordinator::goodbye(Worker& worker, const wire::Goodbye& goodbye, Time now) {
  const std::string reason = printable(goodbye.reason(), 200);
  peer_log_.info(now, "worker {} on {} left: {}", worker.pid, worker.host, reason);
  chronicle_.left(worker, reason, now);
  leases_.giveBack(worker.id);
  registry_.remove(worker, "left", now);
}

void Coordinator::heartbeat(Worker& worker, const wire::Heartbeat& heartbeat, Time now) {
  worker.solving.reset();
  if (heartbeat.solving()) {
    worker.idle_since.reset();
    for (const TransitionKey& key : leases_.openOf(worker.id, heartbeat.job()))
      if (plans_[key.space].positions().point(key.target) == fromWire(heartbeat.target()))
        worker.solving = key;
  } else if (leases_.leasedTo(worker.id) > 0 && !worker.idle_since) {
    worker.idle_since = now;
    silence_due_ = std::min(silence_due_, now + settings_.idle_with_leases);
  }
  send(worker.peer).mutable_heartbeat_reply()->set_incarnation(incarnation_);
  if (everybodyIsToLeave()) drain(worker.peer);
}

/// Whoever has others is asked who it is again, and told then to take these, or why it may not
/// stay.
void Coordinator::settleKernels(const std::string& family, Time now) {
  registry_.setKernelFamily(family);
  std::vector<const Worker*> others;
  for (const auto& [id, worker] : registry_.all())
    if (worker.kernel_family != family) others.push_back(&worker);
  for (const Worker* worker : others) {
    send(worker->peer).mutable_heartbeat_reply();
    leases_.giveBack(worker->id);
    registry_.remove(*worker, "left", now);
  }
}

bool Coordinator::deserted(Time now) const {
  // Workers that are drained leave without a word when the build is complete.
  return std::ranges::all_of(registry_.all(), [&](const auto& entry) {
    return now - entry.second.heard > 3 * settings_.heartbeat;
  });
}

void Coordinator::dismiss() {
  dismissed_ = true;
  drainAll();
}

void Coordinator::noteOwnGap(Time now) {
  const auto gap = now - std::exchange(last_turn_, now);
  if (gap < settings_.own_gap || registry_.all().empty()) return;
  spdlog::warn(
      "this scheduler did nothing for {:.0f} s (stopped, suspended, or without processor "
      "time): no worker is blamed for the silence",
      std::chrono::duration<double>(gap).count());
  for (auto& [id, worker] : registry_.all()) {
    worker.heard += gap;
    if (worker.idle_since) *worker.idle_since += gap;
    if (worker.probed) *worker.probed += gap;
    worker.moved += gap;
  }
  if (only_checks_left_) *only_checks_left_ += gap;
}

/// When nothing waits, and somebody who is known to work has nothing to do, what others do not come
/// to is put back, the last first. Whoever finds it first is right, as always.
void Coordinator::takeBackForTheIdle(Time now) {
  if (!handsOut() || leases_.waiting() > 0) return;
  const bool all_are_new = std::ranges::none_of(
      registry_.all(), [](const auto& entry) { return entry.second.earned > 0; });
  int idle = 0;
  registry_.eachAsking([&](const Worker& worker) {
    idle += (worker.earned > 0 || all_are_new) && leases_.leasedTo(worker.id) == 0 &&
            roomOf(worker) > 0;
    return true;
  });
  for (auto& [id, worker] : registry_.all()) {
    if (idle == 0) return;
    const auto last = leases_.lastOf(id);
    // Of checks: giveUpChecks.
    if (!last || last->is_check || !allotment_.isOverdue(worker, last->attempts, now)) continue;
    takeBackLast(worker, now);
    --idle;
  }
}

void Coordinator::takeBackLast(Worker& worker, Time now) {
  if (!worker.overdue_until)
    peer_log_.info(now, "worker {} on {} holds what others could do: they are given it", worker.pid,
                   worker.host);
  ++counters_["overdue_targets"];
  leases_.giveBackLast(worker.id);
  allotment_.noteOverdue(worker, now);
}

/// At all workers, now and then: it costs the more, the more there are.
void Coordinator::lookRound(Time now) {
  takeBackFromTheIdle(now);
  takeBackForTheIdle(now);
  probeSilentWorkers(now);
  loseSilentWorkers(now);
  look_round_at_ = now + looked_at_every * registry_.all().size();
  silence_due_ = Time::max();
  for (const auto& [id, worker] : registry_.all()) {
    silence_due_ = std::min(silence_due_, worker.heard + settings_.worker_lost);
    if (worker.idle_since)
      silence_due_ = std::min(silence_due_, *worker.idle_since + settings_.idle_with_leases);
  }
}

void Coordinator::takeBackFromTheIdle(Time now) {
  for (auto& [id, worker] : registry_.all()) {
    if (!worker.idle_since || now - *worker.idle_since < settings_.idle_with_leases) continue;
    peer_log_.warn(now, "worker {} on {} does not solve what it was given: it is handed out again",
                   worker.pid, worker.host);
    registry_.addCredit(worker, leases_.jobsOf(id).size());
    worker.idle_since.reset();
    leases_.giveBack(id);
  }
}

void Coordinator::loseSilentWorkers(Time now) {
  // Found first: the registry must not change while it is walked.
  std::vector<const Worker*> silent;
  for (const auto& [id, worker] : registry_.all())
    if (now - worker.heard >= settings_.worker_lost) silent.push_back(&worker);
  for (const Worker* worker : silent) {
    peer_log_.warn(now, "worker {} on {} says nothing any more; {} targets are handed out again",
                   worker->pid, worker->host, leases_.leasedTo(worker->id));
    chronicle_.lost(*worker, "silent", leases_.leasedTo(worker->id), now);
    lose(*worker, now);
  }
}

void Coordinator::probeSilentWorkers(Time now) {
  const auto patience = settings_.silent_heartbeats * settings_.heartbeat;
  for (auto& [id, worker] : registry_.all()) {
    // Or had work, which others were given meanwhile.
    const bool at_work = leases_.leasedTo(id) > 0 || worker.overdue_until;
    if (now - worker.heard < patience || !at_work) continue;
    if (worker.probed && now - *worker.probed < settings_.heartbeat) continue;
    worker.probed = now;
    send(worker.peer).mutable_heartbeat_reply()->set_incarnation(incarnation_);
  }
}

/// Nobody is to blame as long as its process is not known to have ended.
void Coordinator::lose(const Worker& worker, Time now) {
  departed_.emplace_back(worker.id, leases_.suspectsOf(worker.id, worker.solving));
  if (departed_.size() > most_departed) departed_.pop_front();
  leases_.giveBack(worker.id);
  if (!everybodyIsToLeave()) ++counters_["lost_workers"];
  registry_.remove(worker, everybodyIsToLeave() ? "left" : "lost", now);
}

void Coordinator::peerUnreachable(const std::string& peer, Time now) {
  const Worker* worker = registry_.ofPeer(peer);
  if (worker == nullptr) return;
  // Its goodbye may wait unread behind what could not be sent to it any more.
  if (everybodyIsToLeave() && leases_.leasedTo(worker->id) == 0) {
    peer_log_.info(now, "worker {} on {} left", worker->pid, worker->host);
    chronicle_.left(*worker, "it was told to", now);
    return lose(*worker, now);
  }
  peer_log_.info(now, "worker {} on {} cannot be reached; {} targets are handed out again",
                 worker->pid, worker->host, leases_.leasedTo(worker->id));
  chronicle_.lost(*worker, "unreachable", leases_.leasedTo(worker->id), now);
  lose(*worker, now);
}

void Coordinator::noteClosed(const Connections::Closed& closed, Time now) {
  if (closed.count == 0) return;
  counters_["closed_connections"] += closed.count;
  for (const std::string& why : closed.why) peer_log_.warn(now, "{}", why);
}

void Coordinator::workerProcessEnded(std::uint32_t pid, Time now) {
  if (const Worker* worker = registry_.ofProcess(pid)) processEnded(std::string(worker->id), now);
}

void Coordinator::processEnded(const std::string& worker_id, Time now) {
  if (const Worker* worker = registry_.find(worker_id)) {
    peer_log_.warn(now, "worker {} on {} ended unexpectedly; {} targets are handed out again",
                   worker->pid, worker->host, leases_.leasedTo(worker_id));
    chronicle_.ended(*worker, leases_.leasedTo(worker_id), now);
    lose(*worker, now);
  }
  const auto departed =
      std::ranges::find(departed_, worker_id, [](const auto& entry) { return entry.first; });
  // It left, or an earlier run of this scheduler knew it.
  if (departed == departed_.end()) return;
  blame(departed->second);
  departed_.erase(departed);
}

void Coordinator::blame(const Leases::Suspects& suspects) {
  for (const auto& [key, losses] : leases_.blame(suspects)) {
    store_->tables().writeLosses(key, losses);
    if (losses.deaths != deaths_before_aside) continue;
    chronicle_.setAside(key, plans_[key.space], losses.deaths);
    spdlog::error(
        "{}: {} workers ended while they solved it; it is set aside, and the rest goes on without "
        "it",
        textOf(keyOf(plans_, key)), losses.deaths);
  }
}

void Coordinator::drain(const std::string& peer) {
  send(peer).mutable_drain()->set_finished(complete());
}

void Coordinator::drainAll() {
  for (const auto& [id, worker] : registry_.all()) drain(worker.peer);
}

}  // namespace palpate
