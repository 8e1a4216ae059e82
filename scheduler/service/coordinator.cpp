#include "scheduler/service/coordinator.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "common/base/assertion.hpp"
#include "common/base/bytes32.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds servers_written_every{5};
/// When somebody came meanwhile: at once, since people look for the worker that they just started;
/// with many it takes a while for each, or a flood of newcomers would have all rows written again
/// for every one of them.
constexpr std::chrono::milliseconds newcomers_written_after{1};  // times:
constexpr std::size_t workers_per_wait = 8;
/// Of a flood of bad messages the first ones tell what there is to tell.
constexpr std::int64_t bad_messages_logged = 20;
/// Large answers to one peer in a turn: it has read none of them when it asks.
constexpr int large_in_a_turn = 2;

/// Who comes before whom when jobs are handed out: the smaller one.
struct Load {
  bool busy, newcomer;
  std::size_t held;     ///< targets
  Worker::Time waited;  ///< of newcomers, since then they were given nothing
  Worker* worker;

  bool operator>(const Load& other) const {
    return std::tie(busy, newcomer, held, waited, worker->id) >
           std::tie(other.busy, other.newcomer, other.held, other.waited, other.worker->id);
  }
};

bool asksForMuch(const wire::Message& message) {
  return message.has_status_request() || message.has_problem_request() ||
         message.has_fields_request();
}

}  // namespace

Coordinator::Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store,
                         Time now, const CoordinatorSettings& settings)
    : problem_(&problem),
      problem_bytes_(std::make_shared<const std::string>(std::move(problem_bytes))),
      build_(store.build()),
      check_(problem, build_),
      seal_(store.tables().secret()),
      checks_(settings.spot_checks, store.tables().secret()),
      store_(&store),
      settings_(settings),
      incarnation_(randomBytes(16)),
      losses_(store.tables().losses()),
      due_checks_(store.tables().checks()),
      registry_(store.kernelFamily().empty() ? settings.kernel_family : store.kernelFamily(),
                store.keptOut()),
      allotment_(settings.allotment),
      group_(store),
      counters_(store.tables().counters()),
      started_(now),
      last_turn_(now),
      servers_written_(now),
      peer_log_(now),
      chronicle_(problem, settings.events, now),
      pace_(now),
      work_pace_(now),
      paused_(store.tables().paused()) {
  ++counters_["runs"];
  // The upper half of a job number is the run, so that two runs never use the same.
  leases_ = Leases(static_cast<std::uint64_t>(counters_["runs"]) << 32);
  found_ = store_->found();
  longest_solve_ = store_->longestSolve();
  // Their workers may come back any moment.
  for (const auto& [key, host] : store_->givers()) heard_.add(key, host);
  Replay replayed = store_->takeReplay();
  plans_ = std::move(replayed.plans);
  spare_ = std::move(replayed.spare);
  // Where something was lost, what it led to is asked for again in time.
  if (!store_->damaged() && replayed.settled.stale.empty()) refuseSpare(spare_);
  PALPATE_ASSERT(plans_.size() == problem.active.size(), "every active node has its plan");
  for (const auto& [name, priority] : store_->tables().priorities()) prioritize(name, priority);
  chronicle_.begin(plans_);
  add(replayed.settled);
  openChecks();
  store_->tables().writeCounters(counters_);
  writeProgress(now);
  finishIfComplete(now);
}

void Coordinator::receive(const Incoming& incoming, Time now) {
  if (next() == Next::anew) return;
  noteOwnGap(now);
  const wire::Message& message = incoming.message;
  const std::string& peer = incoming.peer;
  // Workers say it again to the next one.
  if (turns_since_retry_) return void(answer(incoming, now));
  if (message.has_hello()) return hello(incoming, now);
  // It asks again.
  if (asksForMuch(message) && (incoming.reads_slowly || ++large_answers_[peer] > large_in_a_turn)) {
    ++counters_["unread_answers"];
    return;
  }
  if (answer(incoming, now)) return;
  Worker* const worker = registry_.ofPeer(peer);
  if (worker == nullptr) {
    if (message.body_case() == wire::Message::BODY_NOT_SET)
      return badMessage(peer, "it cannot be read");
    // An empty incarnation is never the one a worker knows, so it says hello, and then resends what
    // was not acknowledged.
    send(peer).mutable_heartbeat_reply();
    return;
  }
  worker->heard = now;
  worker->probed.reset();
  if (message.has_problem_request()) return sendProblem(*worker);
  if (message.has_request()) return request(*worker, message.request());
  if (message.has_fields_request()) return sendFields(*worker, message.fields_request());
  if (message.has_result()) return result(*worker, incoming, now);
  if (message.has_heartbeat()) return heartbeat(*worker, message.heartbeat(), now);
  if (message.has_goodbye()) return goodbye(*worker, message.goodbye(), now);
  badMessage(peer, "workers do not send that");
}

void Coordinator::refuse(const Incoming& incoming, Time now) {
  send(incoming.peer).mutable_refused()->set_reason(incoming.refusal);
  badMessage(incoming.peer, incoming.refusal);
  if (const Worker* worker = registry_.ofPeer(incoming.peer)) {
    chronicle_.refused(worker->host, worker->pid, incoming.refusal, now);
    lose(*worker, now);
  }
}

void Coordinator::request(Worker& worker, const wire::Request& request) {
  // It may have missed the first word to leave.
  if (everybodyIsToLeave()) return drain(worker.peer);
  if (request.afresh()) worker.credit = 0;
  registry_.addCredit(worker, request.credit());
}

void Coordinator::sendProblem(const Worker& worker) {
  wire::ProblemReply& reply = *send(worker.peer, problem_bytes_).mutable_problem_reply();
  reply.set_build(std::string(build_.bytes()));
  reply.set_payload_bytes(static_cast<std::uint32_t>(problem_bytes_->size()));
}

void Coordinator::sendFields(const Worker& worker, const wire::FieldsRequest& request) {
  if (unread_starts_.bytes() > settings_.unread_starts) {
    ++counters_["unread_answers"];
    return;
  }
  std::optional<JournalRecord> found;
  const LatticePoint point = fromWire(request.point());
  if (const auto key = transitionOf(plans_, {request.space(), point, point}))
    // The point may have another equilibrium by now than the one the job started from.
    if (const CompactPoints& points = plans_[key->space].points();
        isSolved(points.tag(key->target)) && points.fields(key->target).bytes() == request.id())
      found = store_->find(keyOf(plans_, {key->space, key->target, points.parent(key->target)}));
  if (!found)
    if (const auto solver = checks_.solverOfStart(request.id())) found = store_->find(*solver);
  const bool known = found.has_value();
  std::shared_ptr<const std::string> payload;
  if (known) payload = unread_starts_.add(std::move(found->payload));
  wire::FieldsReply& reply = *send(worker.peer, payload).mutable_fields_reply();
  reply.set_id(request.id());
  reply.set_unknown(!known);
  if (known) reply.set_payload_bytes(static_cast<std::uint32_t>(payload->size()));
}

void Coordinator::result(Worker& worker, const Incoming& incoming, Time now) {
  const wire::Result& message = incoming.message.result();
  // Who delivers is at work, whatever its last heartbeat said.
  worker.idle_since.reset();
  if (const std::string objection =
          check_.objectionTo(message, incoming.payload, worker.kernel_family);
      !objection.empty())
    return badMessage(worker.peer, objection);
  const ResultKey name = keyOf(message);
  const auto key = transitionOf(plans_, name);
  if (!key) return badMessage(worker.peer, "a result for a point that does not exist");
  // Who keeps results over the loss of our secret has them solved again.
  if (!seal_.isSealOf({worker.id, name, message.start_id()}, message.lease())) {
    badMessage(worker.peer, "a result that it was not asked for");
    return unwanted(worker, message);
  }
  if (ResultGroup::Member* waiting = group_.find(*key)) {
    const wire::Result& first = waiting->result.header;
    if (!duplicate(worker, first, message, now)) {
      if (first.given_by().worker() == worker.id) return contradict(worker, message);
      waiting->is_checked = waiting->is_disputed = true;
    }
    waiting->senders.insert(worker.peer);
  } else if (plans_[key->space].isOpen({key->target, key->parent})) {
    if (message.start_id() != startIdOf(plans_[key->space], {key->target, key->parent}))
      return unwanted(worker, message);
    take(worker, *key, incoming, now);
  } else if (const auto recorded = store_->find(name)) {
    wire::Result first;
    const bool readable = first.ParseFromString(recorded->header);
    PALPATE_ASSERT(readable, "what is recorded was read when it was found, or written by us");
    if (message.start_id() != first.start_id()) return unwanted(worker, message);
    acknowledgement(worker.peer, message);
    compare(worker, *key, first, message, now);
  } else {
    unwanted(worker, message);
  }
}

/// Of a transition that what was lost led to, or of another's imagination. As long as it is not
/// answered, an honest worker keeps it and does not leave.
void Coordinator::unwanted(const Worker& worker, const wire::Result& result) {
  ++counters_["unwanted_results"];
  acknowledgement(worker.peer, result).set_unwanted(true);
}

/// The first result of a transition.
void Coordinator::take(Worker& worker, const TransitionKey& key, const Incoming& incoming,
                       Time now) {
  if (registry_.kernelFamily().empty()) settleKernels(worker.kernel_family, now);
  ++worker.results;
  allotment_.noteDelivery(worker, now);
  leases_.finish(key);
  StoredResult stored{incoming.message.result(), *fromWire(incoming.message.result())};
  stored.header.clear_lease();
  *stored.header.mutable_given_by() = worker.provenance;
  const SpacePlan& plan = plans_[key.space];
  stored.header.set_steps(static_cast<std::uint32_t>(plan.stepsOf({key.target, key.parent})));
  stored.header.clear_start_parent();
  if (!stored.header.start_id().empty())
    *stored.header.mutable_start_parent() =
        toWire(plan.positions().point(plan.point(key.parent).parent));
  const bool picked = checks_.pick(keyOf(plans_, key), lookOf(key, stored.outcome));
  group_.add(key, std::move(stored), incoming.payload, now);
  ResultGroup::Member& member = *group_.find(key);
  member.is_checked = picked;
  member.senders.insert(worker.peer);
  if (group_.size() >= settings_.group_results || group_.bytes() >= settings_.group_bytes)
    commitGroup(now);
}

/// Counts it, and tells when it is another result. Whether it is the same.
bool Coordinator::duplicate(const Worker& worker, const wire::Result& first,
                            const wire::Result& second, Time now) {
  ++counters_["duplicate_results"];
  if (ResultCheck::agree(first, second)) return true;
  differs(worker, first, second, now);
  return false;
}

void Coordinator::badMessage(const std::string& peer, const std::string& why) {
  if (++counters_["bad_messages"] > bad_messages_logged) return;
  if (const Worker* worker = registry_.ofPeer(peer))
    spdlog::warn("a message from worker {} on {} was dropped: {}", worker->pid, worker->host, why);
  else
    spdlog::warn("a message from a stranger was dropped: {}", why);
}

bool Coordinator::groupIsDue(Time now, bool all_read) {
  if (!group_.since()) return false;
  const auto age = now - *group_.since();
  if (age >= settings_.group_age || (all_read && age >= settings_.group_age_all_read)) return true;
  // Somebody waits for what these results may make ready.
  return leases_.waiting() == 0 && registry_.someoneAsks();
}

void Coordinator::commitGroup(Time now) {
  // Plans that hold what was dropped must not come to an end.
  if (group_.size() == 0 || turns_since_retry_) return;
  // Before they are durable, or one that is killed in between would never be checked.
  for (const auto& [key, member] : group_.members())
    if (member.is_checked) noteCheck(keyOf(member.result.header), member.is_disputed);
  // Plans move on only after this: what they ask for next may rest on what is in the group.
  const ResultGroup::Members durable = group_.commit();
  for (const auto& [key, member] : durable) {
    for (const std::string& peer : member.senders) acknowledgement(peer, member.result.header);
    SpacePlan& plan = plans_[key.space];
    plan.record({key.target, key.parent}, member.result.outcome, fieldsOf(member.result.header));
    ++recorded_;
    longest_solve_ = std::max(longest_solve_, member.result.outcome.cost.seconds);
    converged_ += member.result.outcome.converged;
    if (!member.result.outcome.converged)
      chronicle_.failed(key, plan, member.result.outcome.failure, member.result.header.given_by());
    add(settle(plans_, key.space, spare_,
               [this](const ResultKey& spare) { return store_->read(spare); }));
    chronicle_.wentOn(key.space, plan);
  }
  openChecks();
  finishIfComplete(now);
  // These may be the last of this run.
  if (stopping_) writeProgress(now);
}

void Coordinator::add(const Settled& settled) {
  store_->drop(settled.stale);
  for (const TransitionKey& key : settled.missing) {
    const auto known = losses_.find(key);
    leases_.add(key, known == losses_.end() ? Losses() : known->second);
  }
}

void Coordinator::finishIfComplete(Time now) {
  if (complete() || !std::ranges::all_of(plans_, &SpacePlan::complete)) return;
  openChecks();
  forgetChecksOfNothing();
  if (checks_.openCount() + due_checks_.size() > 0) return;
  PALPATE_ASSERT(group_.size() == 0 && leases_.empty(),
                 "a complete plan waits for no result, and nobody solves for it");
  complete_ = true;
  chronicle_.completed(recorded_, std::chrono::duration<double>(now - started_).count());
  writeServers(now);
}

Next Coordinator::next() const {
  if (!liars_.empty() || turns_since_retry_ >= 2) return Next::anew;
  if (complete_) return Next::complete;
  if (stopping_) return Next::stop;
  return stuck() ? Next::stuck : Next::go_on;
}

Next Coordinator::advance(Time now, bool all_read) {
  if (turns_since_retry_) ++*turns_since_retry_;
  if (turns_since_retry_ || !liars_.empty()) return next();
  noteOwnGap(now);
  if (all_read && now >= look_round_at_) lookRound(now);
  if (groupIsDue(now, all_read)) commitGroup(now);
  handOutJobs(now);
  giveUpChecks(now);
  if (now >= serversDue()) writeServers(now);
  pace_.note(now, converged_);
  work_pace_.note(now, recorded_);
  lookAhead(now);
  chronicle_.flush();
  return next();
}

Coordinator::Time Coordinator::nextDeadline() const {
  Time deadline = serversDue();
  if (group_.since()) deadline = std::min(deadline, *group_.since() + settings_.group_age_all_read);
  // Not before there is a look at all of them.
  return std::min(deadline, std::max(silence_due_, look_round_at_));
}

/// Of what it may hold.
std::size_t Coordinator::roomOf(const Worker& worker) const {
  const std::size_t most = allotment_.limitOf(worker, last_turn_);
  return most - std::min(most, leases_.leasedTo(worker.id));
}

/// To those that hold nothing, and then to those that hold least, first to those that are known to
/// do what they are given: the second job of a worker would be the first of another.
void Coordinator::handOutJobs(Time now) {
  const bool checks_wait = !leases_.waitingChecks().empty();
  if (!handsOut() || (leases_.waiting() == 0 && !checks_wait)) return;
  const std::map<TransitionKey, Apart> wanted = wantedOfChecks();
  // Those that are to be given something first on top: there are many, and work for few.
  std::vector<Load> heap;
  std::size_t free_hands = 0;
  const auto add = [&](Worker& worker) {
    if (worker.credit == 0 || roomOf(worker) == 0) return false;
    const bool newcomer = worker.earned == 0;
    const std::size_t held = leases_.leasedTo(worker.id);
    heap.push_back({held > 0, newcomer, held, newcomer ? worker.moved : Time(), &worker});
    free_hands += !newcomer && held == 0;
    return true;
  };
  registry_.eachAsking([&](Worker& worker) {
    add(worker);
    // None of the others would come before these; but a check is not for everybody.
    return checks_wait || free_hands < leases_.waiting();
  });
  std::ranges::make_heap(heap, std::greater());
  while (!heap.empty()) {
    std::ranges::pop_heap(heap, std::greater());
    Worker& worker = *heap.back().worker;
    heap.pop_back();
    const std::string& id = worker.id;
    const std::size_t room = roomOf(worker);
    if (leases_.leasedTo(id) == 0) allotment_.noteFirst(worker, now);
    // There are few of them, and they are to show what is wrong before much rests on it.
    auto handout = leases_.handOutCheck(
        id, [&](const TransitionKey& key) { return mayCheck(key, worker, wanted.at(key)); });
    if (!handout) handout = leases_.handOut(id, registry_.all().size(), room);
    if (!handout && !checks_wait) return;
    if (!handout) continue;
    PALPATE_ASSERT(worker.credit > 0, "only workers that asked for a job are in the list");
    worker.idle_since.reset();
    --worker.credit;
    if (add(worker)) std::ranges::push_heap(heap, std::greater());
    sendJob(worker, *handout);
  }
}

void Coordinator::sendJob(const Worker& worker, const Handout& handout) {
  const SpacePlan& plan = plans_[handout.space];
  PALPATE_ASSERT(!handout.targets.empty(), "a hand-out without targets would be no job");
  wire::Job& job = *send(worker.peer).mutable_job();
  job.set_id(handout.job);  // which heartbeats name
  job.set_hung_after_s(static_cast<std::uint32_t>(hungAfter().count()));
  job.set_space(handout.space);
  *job.mutable_start() = toWire(plan.positions().point(handout.parent));
  // Whatever goes to several targets is none of the rest state, which has a job of its own.
  const TransitionKey first = {handout.space, handout.targets.front(), handout.parent};
  const bool is_check = checks_.isOpen(keyOf(plans_, first));
  job.set_start_id(is_check ? checks_.startOf(keyOf(plans_, first)).id
                            : startIdOf(plan, {first.target, first.parent}));
  for (const std::int32_t target : handout.targets) {
    wire::Target& entry = *job.add_targets();
    *entry.mutable_point() = toWire(plan.positions().point(target));
    const ResultKey key = keyOf(plans_, {handout.space, target, handout.parent});
    entry.set_lease(seal_.sealOf({worker.id, key, job.start_id()}));
    entry.set_steps(is_check ? checks_.startOf(key).steps
                             : static_cast<std::uint32_t>(plan.stepsOf({target, handout.parent})));
  }
}

std::chrono::seconds Coordinator::hungAfter() const {
  if (settings_.hung_after) return *settings_.hung_after;
  if (longest_solve_ <= 0) return settings_.hung_without_any;
  // A week is no limit any more; a worker may claim any cost.
  constexpr double most = 7 * 24 * 3600;
  const double seconds = std::min(settings_.hung_factor * longest_solve_, most);
  return std::max(settings_.hung_at_least, std::chrono::seconds(std::llround(seconds)));
}

Coordinator::Time Coordinator::serversDue() const {
  const auto waits = static_cast<int>(registry_.all().size() / workers_per_wait);
  return servers_written_ + (newcomers_ ? waits * newcomers_written_after : servers_written_every);
}

void Coordinator::writeServers(Time now) {
  std::vector<wire::WorkerStatus> rows = registry_.takeDeparted();
  const std::vector<wire::WorkerStatus> present = registry_.rows(leases_, now);
  rows.insert(rows.end(), present.begin(), present.end());
  store_->checkPresence();
  store_->tables().writeServers(rows);
  store_->tables().writeCounters(counters_);
  if (complete() || stopping_ || now - progress_written_ >= servers_written_every)
    writeProgress(now);
  servers_written_ = now;
  newcomers_ = false;
}

/// What is told of the directory when nobody works there.
void Coordinator::writeProgress(Time now) {
  store_->tables().writeProgress(
      {store_->recorded(),
       toJson(progressOf(*problem_, build_, plans_, registry_.kernelFamily(), complete()))});
  progress_written_ = now;
}

wire::Message& Coordinator::send(const std::string& peer,
                                 std::shared_ptr<const std::string> payload) {
  outbox_.push_back({peer, {}, std::move(payload)});
  return outbox_.back().message;
}

wire::ResultAck& Coordinator::acknowledgement(const std::string& peer, const wire::Result& result) {
  wire::ResultAck& ack = *send(peer).mutable_result_ack();
  ack.set_space(result.space());
  *ack.mutable_target() = result.target();
  *ack.mutable_parent() = result.parent();
  return ack;
}

}  // namespace palpate
