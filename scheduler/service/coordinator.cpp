#include "scheduler/service/coordinator.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"

namespace palpate {

Coordinator::Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store,
                         Time now, const CoordinatorSettings& settings)
    : state_{problem, store, settings, now},
      workers_(state_),
      seconds_(state_, workers_),
      handouts_(state_, workers_, seconds_, std::move(problem_bytes)),
      intake_(state_, workers_, seconds_, handouts_),
      people_(state_, workers_, seconds_, intake_),
      last_turn_(now) {
  state_.tables.writeCounters(state_.counters);
  people_.writeProgress();
  goOn();
}

void Coordinator::receive(Incoming incoming, Time now) {
  if (next() == Next::anew) return;
  noteOwnGap(now);
  // A new Build is about to start, so answer only users; workers repeat their messages to it.
  if (state_.turns_since_retry) return void(answer(incoming));
  const wire::Message& message = incoming.message;
  const std::string& peer = incoming.peer;
  if (message.has_hello()) {
    // If this worker is the first on a second machine, results of the first can now be checked.
    if (workers_.hello(incoming)) seconds_.openDue();
    return;
  }
  if (readsTooSlowly(incoming) || answer(incoming)) return;
  Worker* const worker = workers_.registry.ofPeer(peer);
  if (worker == nullptr) {
    if (message.body_case() == wire::Message::BODY_NOT_SET)
      return workers_.badMessage(peer, "it cannot be read");
    // An empty epoch never matches the one that the worker knows, so the worker says hello and then
    // sends its unacknowledged results again.
    state_.send(peer).mutable_heartbeat_reply();
    return;
  }
  worker->heard = now;
  worker->probed.reset();
  switch (message.body_case()) {
    case wire::Message::kProblemRequest: return handouts_.sendProblem(*worker);
    case wire::Message::kRequest: return workers_.request(*worker, message.request());
    case wire::Message::kFieldsRequest:
      return handouts_.sendFields(*worker, message.fields_request());
    case wire::Message::kResult:
      if (intake_.take(*worker, incoming)) goOn();
      if (intake_.isFull()) commit();
      return;
    case wire::Message::kHeartbeat: return workers_.heartbeat(*worker, message.heartbeat());
    case wire::Message::kGoodbye: return workers_.goodbye(*worker, message.goodbye());
    default: workers_.badMessage(peer, "workers do not send messages of this kind");
  }
}

/// Answers a request of an operator or observer. Returns false for other messages.
bool Coordinator::answer(const Incoming& incoming) {
  if (!incoming.message.has_stop_request()) return people_.answer(incoming);
  state_.send(incoming.peer).mutable_stop_reply()->set_stopping(true);
  stop(state_.now);
  return true;
}

/// Returns true if the peer asks for a large answer but has not read earlier ones, or asks for more
/// than two in one turn. The peer will ask again.
bool Coordinator::readsTooSlowly(const Incoming& incoming) {
  constexpr int large_in_a_turn = 2;
  const wire::Message& message = incoming.message;
  if (!message.has_status_request() && !message.has_problem_request() &&
      !message.has_fields_request())
    return false;
  if (!incoming.reads_slowly && ++large_answers_[incoming.peer] <= large_in_a_turn) return false;
  ++state_.counters["unread_answers"];
  return true;
}

void Coordinator::refuse(const Incoming& incoming, Time now) {
  state_.now = now;
  state_.send(incoming.peer).mutable_refused()->set_reason(incoming.refusal);
  workers_.badMessage(incoming.peer, incoming.refusal);
  if (const Worker* worker = workers_.registry.ofPeer(incoming.peer)) {
    state_.chronicle.refused(worker->provenance.host(), worker->pid, incoming.refusal);
    workers_.lose(*worker);
  }
}

void Coordinator::noteClosed(const Connections::Closed& closed, Time now) {
  state_.now = now;
  if (closed.count == 0) return;
  state_.counters["closed_connections"] += closed.count;
  for (const std::string& why : closed.why) state_.chronicle.warn("{}", why);
}

/// Detects that this scheduler itself did nothing for a while. Workers are not blamed for silence
/// in that time.
void Coordinator::noteOwnGap(Time now) {
  state_.now = now;
  const auto gap = now - std::exchange(last_turn_, now);
  if (gap < state_.settings.own_gap || workers_.registry.all().empty()) return;
  spdlog::warn(
      "this scheduler did nothing for {:.0f} s (stopped, suspended, or without processor time); "
      "this time does not count as silence of its workers",
      std::chrono::duration<double>(gap).count());
  workers_.forgiveGap(gap);
  seconds_.forgiveGap(gap);
}

Next Coordinator::next() const {
  if (!state_.liars.empty() || state_.turns_since_retry >= 2) return Next::anew;
  if (state_.complete) return Next::complete;
  if (state_.stopping) return Next::stop;
  return stuck() ? Next::stuck : Next::go_on;
}

Next Coordinator::advance(Time now, bool all_read) {
  if (state_.turns_since_retry) ++*state_.turns_since_retry;
  if (state_.turns_since_retry || !state_.liars.empty()) return next();
  noteOwnGap(now);
  if (all_read) workers_.sweep();
  if (intake_.isDue(all_read)) commit();
  handouts_.handOut();
  seconds_.watch();
  while (seconds_.giveUp()) goOn();
  if (now >= people_.serversDue()) people_.writeServers();
  people_.measure();
  state_.chronicle.flush();
  return next();
}

Coordinator::Time Coordinator::nextDeadline() const {
  return std::min({people_.serversDue(), intake_.deadline(), workers_.nextSweep()});
}

/// Makes the waiting results durable and moves the build on.
void Coordinator::commit() {
  // After a retry, plans still hold the dropped results, so they must not complete.
  if (state_.group.size() == 0 || state_.turns_since_retry) return;
  intake_.commit();
  goOn();
  // Store the progress: these may be the last results of this run.
  if (state_.stopping) people_.writeProgress();
}

/// Opens the checks that have become possible after results or second solves. Completes the build
/// if nothing is left to do.
void Coordinator::goOn() {
  seconds_.openDue();
  if (state_.complete || !std::ranges::all_of(state_.plans, &SpacePlan::complete)) return;
  seconds_.forgetUnneeded();
  if (seconds_.left() > 0) return;
  PALPATE_ASSERT(state_.group.size() == 0 && workers_.leases.empty(),
                 "a complete build must not wait for a result or lease");
  state_.complete = true;
  state_.chronicle.completed(intake_.recorded(),
                             std::chrono::duration<double>(state_.now - state_.started).count());
  people_.writeServers();
}

void Coordinator::stop(Time now) {
  if (state_.stopping) return;
  state_.now = now;
  // Commit first, so that workers get their acknowledgements before they are told to leave.
  commit();
  state_.stopping = true;
  workers_.drainAll();
  people_.writeServers();
}

}  // namespace palpate
