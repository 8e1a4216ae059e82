#include "scheduler/service/intake.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

Intake::Intake(ServiceState& state, Workers& workers, SecondSolves& seconds, Handouts& handouts)
    : state_(state),
      workers_(workers),
      seconds_(seconds),
      handouts_(handouts),
      check_(state.problem, state.store.build()) {
  Replay replayed = state_.store.takeReplay();
  state_.plans = std::move(replayed.plans);
  unclaimed_ = std::move(replayed.unclaimed);
  // If results were lost, keep the unclaimed results: the plans ask for them later.
  if (!state_.store.damaged() && replayed.settled.outdated.empty()) refuseUnclaimed(unclaimed_);
  PALPATE_ASSERT(state_.plans.size() == state.problem.active.size(),
                 "each active node must have a plan");
  state_.chronicle.begin(state_.plans);
  goOn(replayed.settled);
}

bool Intake::take(Worker& worker, Incoming& incoming) {
  const wire::Result& message = incoming.message.result();
  // A worker that delivers is at work, whatever its last heartbeat said.
  worker.idle_since.reset();
  const auto drop = [&](const std::string& why) {
    workers_.badMessage(worker.peer, why);
    return false;
  };
  auto [objection, outcome] = check_.judge(message, incoming.payload, worker.kernel_family);
  if (!objection.empty()) return drop(objection);
  const ResultKey key = keyOf(message);
  const std::optional<Transition> transition = findIn(state_.plans, key);
  if (!transition) return drop("a result for a point that does not exist");
  if (!handouts_.asked(worker, message)) {
    // If the secret was lost with the tables, this also concerns honest results that were leased
    // under it. They are solved again.
    refuseUnwanted(worker, message);
    return drop("a result that was not requested");
  }
  if (ResultGroup::Member* waiting = state_.group.find(key))
    takeAgain(worker, *waiting, message);
  else if (state_.plans[key.space].isOpen(*transition))
    takeFirst(worker, *transition, incoming, std::move(outcome));
  else
    return takeRecorded(worker, message);
  return false;
}

/// Handles another result of a transition whose first result waits to become durable.
void Intake::takeAgain(const Worker& worker, ResultGroup::Member& waiting,
                       const wire::Result& message) {
  const wire::Result& first = waiting.result;
  if (!seconds_.isSame(worker, first, message)) {
    if (first.given_by().worker() == worker.id) return seconds_.contradict(worker, message);
    waiting.is_checked = waiting.is_disputed = true;
  }
  waiting.senders.insert(worker.peer);
}

bool Intake::takeRecorded(Worker& worker, const wire::Result& message) {
  wire::Result first;
  if (const auto recorded = state_.store.find(keyOf(message))) {
    const bool readable = first.ParseFromString(recorded->header);
    PALPATE_ASSERT(readable, "a recorded result must be readable");
    PALPATE_ASSERT(keyOf(first) == keyOf(message), "a result must be recorded under its own key");
    if (message.start_id() == first.start_id()) {
      state_.acknowledge(worker.peer, message);
      return seconds_.compare(worker, first, message);
    }
  }
  refuseUnwanted(worker, message);
  return false;
}

/// Tells a worker that its result is not wanted: the transition depended on a lost result, or the
/// worker invented it. Without an answer, an honest worker would keep the result and never leave.
void Intake::refuseUnwanted(const Worker& worker, const wire::Result& result) {
  ++state_.counters["unwanted_results"];
  state_.acknowledge(worker.peer, result).set_unwanted(true);
}

/// Handles the first result of a transition.
void Intake::takeFirst(Worker& worker, const Transition& transition, Incoming& incoming,
                       Outcome outcome) {
  wire::Result& result = *incoming.message.mutable_result();
  const ResultKey key = keyOf(result);
  const SpacePlan& plan = state_.plans[key.space];
  if (result.start_id() != startIdOf(plan, transition)) return refuseUnwanted(worker, result);
  if (workers_.registry.kernelFamily().empty()) workers_.settleKernels(worker.kernel_family);
  ++worker.results;
  workers_.allotment.noteDelivery(worker, state_.now);
  workers_.leases.finish(key);
  result.clear_lease();
  *result.mutable_given_by() = worker.provenance;
  result.set_steps(static_cast<std::uint32_t>(plan.stepsOf(transition)));
  result.clear_start_parent();
  if (!result.start_id().empty())
    *result.mutable_start_parent() =
        toWire(plan.positions().point(plan.points().parent(transition.parent)));
  const bool picked = seconds_.pick(key, outcome);
  state_.group.add(key,
                   {.result = std::move(result),
                    .outcome = std::move(outcome),
                    .payload = std::move(incoming.payload),
                    .senders = {worker.peer},
                    .is_checked = picked},
                   state_.now);
}

bool Intake::isFull() const {
  return state_.group.size() >= state_.settings.group_results ||
         state_.group.bytes() >= state_.settings.group_bytes;
}

bool Intake::isDue(bool all_read) {
  if (!state_.group.since()) return false;
  const auto age = state_.now - *state_.group.since();
  if (age >= state_.settings.group_age || (all_read && age >= state_.settings.group_age_all_read))
    return true;
  // Commit now if a worker waits for work that these results may make ready.
  return workers_.leases.waiting() == 0 && workers_.registry.someoneAsks();
}

ServiceState::Time Intake::deadline() const {
  return state_.group.since() ? *state_.group.since() + state_.settings.group_age_all_read
                              : ServiceState::Time::max();
}

void Intake::commit() {
  // Note the checks before the commit: if the scheduler were killed after a commit without them,
  // these results would never be checked.
  for (const auto& [key, member] : state_.group.members())
    if (member.is_checked) seconds_.note(key, member.is_disputed);
  // Move plans on only after the commit, because their next transitions may start from results of
  // the group.
  const ResultGroup::Members durable = state_.group.commit();
  for (const auto& [key, member] : durable) {
    const Outcome& outcome = member.outcome;
    PALPATE_ASSERT(state_.store.knows(key), "a result must be recorded before it is acknowledged");
    for (const std::string& peer : member.senders) state_.acknowledge(peer, member.result);
    SpacePlan& plan = state_.plans[key.space];
    plan.record(*plan.find(key), outcome, fieldsOf(member.result));
    ++recorded_;
    handouts_.noteSolve(outcome.cost.seconds);
    converged_ += outcome.converged();
    if (!outcome.converged())
      state_.chronicle.failed(key, outcome.failure(), member.result.given_by());
    Settled settled;
    settle(
        plan, unclaimed_,
        [this](const ResultKey& unclaimed) { return state_.store.read(unclaimed); }, settled);
    goOn(settled);
    state_.chronicle.wentOn(key.space, plan);
  }
}

void Intake::goOn(const Settled& settled) {
  state_.store.drop(settled.outdated);
  workers_.addReady(settled.missing);
}

}  // namespace palpate
