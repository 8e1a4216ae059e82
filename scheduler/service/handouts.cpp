#include "scheduler/service/handouts.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/base/assertion.hpp"

namespace palpate {
namespace {

/// A worker that may get a job, ordered by the fields below: the smallest gets the next job.
struct Load {
  bool busy, newcomer;
  std::size_t held;     ///< number of targets
  Worker::Time waited;  ///< for newcomers: Worker::moved, so the longest wait comes first
  std::string_view id;
  Worker* worker;
  auto operator<=>(const Load&) const = default;
};

}  // namespace

Handouts::Handouts(ServiceState& state, Workers& workers, const SecondSolves& seconds,
                   std::string problem_bytes)
    : state_(state),
      workers_(workers),
      seconds_(seconds),
      problem_bytes_(std::make_shared<const std::string>(std::move(problem_bytes))),
      secret_(state.tables.secret()),
      longest_solve_(state.store.longestSolve()) {}

void Handouts::handOut() {
  const bool checks_wait = !workers_.leases.waitingChecks().empty();
  if (!state_.handsOut() || (workers_.leases.waiting() == 0 && !checks_wait)) return;
  const std::map<ResultKey, Apart> wanted = seconds_.wanted();
  // A heap with the worker that gets the next job on top, because there are many workers and few
  // jobs.
  std::vector<Load> heap;
  std::size_t free_hands = 0;
  const auto add = [&](Worker& worker) {
    if (worker.credit == 0 || workers_.roomOf(worker) == 0) return false;
    const bool newcomer = worker.earned == 0;
    const std::size_t held = workers_.leases.leasedTo(worker.id);
    heap.push_back(
        {held > 0, newcomer, held, newcomer ? worker.moved : Worker::Time(), worker.id, &worker});
    free_hands += !newcomer && held == 0;
    return true;
  };
  workers_.registry.eachAsking([&](Worker& worker) {
    add(worker);
    // Stop once enough workers are idle and proven, because no other worker would come before them.
    // Go on if checks wait, because not every worker may take a check.
    return checks_wait || free_hands < workers_.leases.waiting();
  });
  std::ranges::make_heap(heap, std::greater());
  while (!heap.empty()) {
    std::ranges::pop_heap(heap, std::greater());
    Worker& worker = *heap.back().worker;
    heap.pop_back();
    const std::string& id = worker.id;
    const std::size_t room = workers_.roomOf(worker);
    if (workers_.leases.leasedTo(id) == 0) workers_.allotment.noteFirst(worker, state_.now);
    // Try checks first: they are few, and should find errors before much depends on a wrong result.
    auto handout = workers_.leases.handOutCheck(
        id, [&](const ResultKey& key) { return seconds_.mayTake(worker, key, wanted.at(key)); });
    if (!handout) handout = workers_.leases.handOut(id, workers_.registry.all().size(), room);
    if (!handout && !checks_wait) return;
    if (!handout) continue;
    PALPATE_ASSERT(worker.credit > 0, "only a worker that asked for a job may get one");
    worker.idle_since.reset();
    --worker.credit;
    if (add(worker)) std::ranges::push_heap(heap, std::greater());
    sendJob(worker, *handout);
  }
}

void Handouts::sendJob(const Worker& worker, const Handout& handout) {
  const ResultKey& first = handout.targets.front();
  const SpacePlan& plan = state_.plans[first.space];
  const SpotChecks& checks = seconds_.checks();
  wire::Job& job = *state_.send(worker.peer).mutable_job();
  job.set_id(handout.job);  // heartbeats name this id
  job.set_hung_after_s(static_cast<std::uint32_t>(hungAfter().count()));
  job.set_space(first.space);
  *job.mutable_start() = toWire(first.parent);
  // All targets of a job have the same start, so the first target decides which. The solve from the
  // rest state is alone in its job, because no other transition is ready before it ends.
  const bool is_check = checks.isOpen(first);
  job.set_start_id(is_check ? checks.startOf(first).id : startIdOf(plan, *plan.find(first)));
  for (const ResultKey& key : handout.targets) {
    PALPATE_ASSERT(key.space == first.space && key.parent == first.parent,
                   "all transitions of a job must have the same start");
    wire::Target& entry = *job.add_targets();
    *entry.mutable_point() = toWire(key.target);
    entry.set_lease(leaseSeal({worker.id, key, job.start_id()}, secret_));
    entry.set_steps(is_check ? checks.startOf(key).steps
                             : static_cast<std::uint32_t>(plan.stepsOf(*plan.find(key))));
  }
}

std::chrono::seconds Handouts::hungAfter() const {
  if (state_.settings.hung_after) return *state_.settings.hung_after;
  if (longest_solve_ <= 0) return state_.settings.hung_without_any;
  // Limit the time to a week, because a worker may claim any duration.
  constexpr double most = 7 * 24 * 3600;
  const double seconds = std::min(state_.settings.hung_factor * longest_solve_, most);
  return std::max(state_.settings.hung_at_least, std::chrono::seconds(std::llround(seconds)));
}

bool Handouts::asked(const Worker& worker, const wire::Result& result) const {
  return isLeaseSeal(result.lease(), {worker.id, keyOf(result), result.start_id()}, secret_);
}

void Handouts::sendProblem(const Worker& worker) {
  wire::ProblemReply& reply = *state_.send(worker.peer, problem_bytes_).mutable_problem_reply();
  reply.set_build(std::string(state_.store.build().bytes()));
  reply.set_payload_bytes(static_cast<std::uint32_t>(problem_bytes_->size()));
}

void Handouts::sendFields(const Worker& worker, const wire::FieldsRequest& request) {
  if (unread_starts_.bytes() > state_.settings.unread_starts) {
    ++state_.counters["unread_answers"];
    return;
  }
  std::shared_ptr<const std::string> payload;
  if (const auto solver = solverOf(request))
    if (auto found = state_.store.find(*solver))
      payload = unread_starts_.add(std::move(found->payload));
  wire::FieldsReply& reply = *state_.send(worker.peer, payload).mutable_fields_reply();
  reply.set_id(request.id());
  reply.set_unknown(!payload);
  if (payload) reply.set_payload_bytes(static_cast<std::uint32_t>(payload->size()));
}

/// Returns the recorded result that holds the requested fields.
std::optional<ResultKey> Handouts::solverOf(const wire::FieldsRequest& request) const {
  const LatticePoint at = fromWire(request.point());
  if (const auto point = findIn(state_.plans, {request.space(), at, at})) {
    const SpacePlan& plan = state_.plans[request.space()];
    const CompactPoints& points = plan.points();
    // The point may by now have another equilibrium than the one from which the job started.
    if (isSolved(points.tag(point->target)) && points.fields(point->target).bytes() == request.id())
      return plan.keyOf({point->target, points.parent(point->target)});
  }
  return seconds_.checks().solverOfStart(request.id());
}

}  // namespace palpate
