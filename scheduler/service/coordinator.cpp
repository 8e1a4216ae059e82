#include "scheduler/service/coordinator.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/printable.hpp"
#include "common/base/random_bytes.hpp"

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
/// Of so many workers that went it is remembered what they had.
constexpr std::size_t most_departed = 4096;
/// Large answers to one peer in a turn: it has read none of them when it asks.
constexpr int large_in_a_turn = 2;
/// Workers that ended, of one Hello: a supervisor tells of one.
constexpr int most_ended = 64;

bool asksForMuch(const wire::Message& message) {
  return message.has_status_request() || message.has_problem_request() ||
         message.has_fields_request();
}

}  // namespace

Coordinator::Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store,
                         Time now, CoordinatorSettings settings)
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
  StoredResults results = store_->takeFound();
  found_ = results.size();
  for (const auto& [key, result] : results) {
    longest_solve_ = std::max(longest_solve_, result.outcome.cost.seconds);
    // Its workers may come back any moment.
    keys_heard_[result.header.given_by().key()] = now;
  }
  Replay replayed = replay(problem, std::move(results));
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
  store_->tables().showAll(plans_);
  finishIfComplete(now);
}

void Coordinator::receive(const Incoming& incoming, Time now) {
  noteOwnGap(now);
  const wire::Message& message = incoming.message;
  const std::string& peer = incoming.peer;
  // Workers say it again to the next one.
  if (!begins_anew_.empty()) return void(answer(incoming, now));
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

bool Coordinator::answer(const Incoming& incoming, Time now) {
  const wire::Message& message = incoming.message;
  const std::string& peer = incoming.peer;
  switch (message.body_case()) {
    case wire::Message::kStatusRequest:
      send(peer).mutable_status_reply()->set_json(recentStatus(now));
      return true;
    case wire::Message::kStopRequest:
      send(peer).mutable_stop_reply()->set_stopping(true);
      stop(now);
      return true;
    case wire::Message::kPauseRequest:
      pause(message.pause_request().paused());
      send(peer).mutable_pause_reply()->set_paused(paused_);
      return true;
    case wire::Message::kRetryRequest: {
      const std::string& cause = message.retry_request().cause();
      const std::int32_t transitions = cause.empty() ? retry() : retryFailed(cause);
      send(peer).mutable_retry_reply()->set_transitions(static_cast<std::uint32_t>(transitions));
      return true;
    }
    case wire::Message::kPriorityRequest: {
      const wire::PriorityRequest& asked = message.priority_request();
      const std::string objection = prioritize(asked.space(), asked.priority());
      if (objection.empty()) {
        store_->tables().writePriority(asked.space(), asked.priority());
        chronicle_.prioritized(asked.space(), asked.priority());
      }
      send(peer).mutable_priority_reply()->set_objection(objection);
      return true;
    }
    default: return false;
  }
}

void Coordinator::refuse(const Incoming& incoming, Time now) {
  send(incoming.peer).mutable_refused()->set_reason(incoming.refusal);
  badMessage(incoming.peer, incoming.refusal);
  if (const Worker* worker = registry_.ofPeer(incoming.peer)) {
    chronicle_.refused(worker->host, worker->pid, incoming.refusal, now);
    lose(*worker, now);
  }
}

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
  peer_log_.info(now, "worker {} on {} joined ({} kernels)", worker.pid, worker.host,
                 worker.kernel_family);
  chronicle_.joined(worker, now);
  newcomers_ = true;
  keys_heard_[worker.provenance.key()] = now;

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
  keys_heard_[worker.provenance.key()] = now;
  registry_.remove(worker, "left", now);
}

void Coordinator::request(Worker& worker, const wire::Request& request) {
  // It may have missed the first word to leave.
  if (everybodyIsToLeave()) return drain(worker.peer);
  if (request.afresh()) worker.credit = 0;
  worker.addCredit(request.credit());
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
  if (const auto key = keyOf(request.space(), request.point(), request.point()))
    // The point may have another equilibrium by now than the one the job started from.
    if (const PointRecord& point = plans_[key->space].point(key->target);
        isSolved(point.tag) && point.fields.bytes() == request.id())
      found = store_->find(resultKeyOf({key->space, key->target, point.parent}));
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

void Coordinator::heartbeat(Worker& worker, const wire::Heartbeat& heartbeat, Time now) {
  worker.solving.reset();
  if (heartbeat.solving()) {
    worker.idle_since.reset();
    for (const TransitionKey& key : leases_.openOf(worker.id, heartbeat.job()))
      if (plans_[key.space].positions().point(key.target) == fromWire(heartbeat.target()))
        worker.solving = key;
  } else if (leases_.leasedTo(worker.id) > 0 && !worker.idle_since) {
    worker.idle_since = now;
  }
  send(worker.peer).mutable_heartbeat_reply()->set_incarnation(incarnation_);
  if (everybodyIsToLeave()) drain(worker.peer);
}

void Coordinator::result(Worker& worker, const Incoming& incoming, Time now) {
  const wire::Result& message = incoming.message.result();
  // Who delivers is at work, whatever its last heartbeat said.
  worker.idle_since.reset();
  if (const std::string objection =
          check_.objectionTo(message, incoming.payload, worker.kernel_family);
      !objection.empty())
    return badMessage(worker.peer, objection);
  const auto key = keyOf(message.space(), message.target(), message.parent());
  if (!key) return badMessage(worker.peer, "a result for a point that does not exist");
  // Who keeps results over the loss of our secret has them solved again.
  if (!seal_.isSealOf({worker.id, palpate::keyOf(message), message.start_id()}, message.lease())) {
    badMessage(worker.peer, "a result that it was not asked for");
    return unwanted(worker, message);
  }
  if (ResultGroup::Member* waiting = group_.find(*key)) {
    const wire::Result& first = waiting->result.header;
    if (!duplicate(worker, first, message, now)) {
      if (first.given_by().worker() == worker.id) throw contradiction(worker, message);
      waiting->is_checked = waiting->is_disputed = true;
    }
    waiting->senders.insert(worker.peer);
  } else if (plans_[key->space].isOpen({key->target, key->parent})) {
    if (message.start_id() != startIdOf(plans_[key->space], {key->target, key->parent}))
      return unwanted(worker, message);
    take(worker, *key, incoming, now);
  } else if (const auto recorded = store_->find(palpate::keyOf(message))) {
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
  const SpotChecks::Picked picked =
      checks_.pick(resultKeyOf(key), worker.results, lookOf(key, stored.outcome));
  group_.add(key, std::move(stored), incoming.payload, now);
  ResultGroup::Member& member = *group_.find(key);
  member.is_checked = picked != SpotChecks::Picked::no;
  member.is_odd = picked == SpotChecks::Picked::as_odd;
  member.senders.insert(worker.peer);
  if (group_.size() >= settings_.group_results || group_.bytes() >= settings_.group_bytes)
    commitGroup(now);
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

bool Coordinator::groupIsDue(Time now) const {
  if (!group_.since()) return false;
  if (now - *group_.since() >= settings_.group_age) return true;
  // Somebody waits for what these results may make ready.
  return leases_.waiting() == 0 && std::ranges::any_of(registry_.all(), [](const auto& entry) {
           return entry.second.credit > 0;
         });
}

void Coordinator::commitGroup(Time now) {
  // Plans that hold what was dropped must not come to an end.
  if (group_.size() == 0 || !begins_anew_.empty()) return;
  // Before they are durable, or one that is killed in between would never be checked.
  for (const auto& [key, member] : group_.members()) noteChecks(member);
  // Plans move on only after this: what they ask for next may rest on what is in the group.
  const ResultGroup::Members durable = group_.commit();
  for (const auto& [key, member] : durable) {
    for (const std::string& peer : member.senders) acknowledgement(peer, member.result.header);
    SpacePlan& plan = plans_[key.space];
    plan.record({key.target, key.parent}, member.result.outcome, fieldsOf(member.result.header));
    noteChanged(key, now);
    ++recorded_;
    longest_solve_ = std::max(longest_solve_, member.result.outcome.cost.seconds);
    converged_ += member.result.outcome.converged;
    if (!member.result.outcome.converged)
      chronicle_.failed(key, plan, member.result.outcome.failure, member.result.header.given_by());
    add(settle(plan, key.space, spare_));
    chronicle_.wentOn(key.space, plan);
  }
  openChecks();
  finishIfComplete(now);
}

void Coordinator::noteChanged(const TransitionKey& key, Time now) {
  if (changed_.empty()) changed_since_ = now;
  changed_.push_back({key.space, key.target});
}

void Coordinator::showChanged() {
  if (changed_.empty()) return;
  store_->tables().show(plans_, changed_);
  changed_.clear();
}

void Coordinator::add(const Settled& settled) {
  store_->drop(settled.stale);
  for (const TransitionKey& key : settled.missing) {
    const auto known = losses_.find(key);
    leases_.add(key, known == losses_.end() ? Losses() : known->second);
  }
}

ResultKey Coordinator::resultKeyOf(const TransitionKey& key) const {
  const Lattice& positions = plans_[key.space].positions();
  return {key.space, positions.point(key.target), positions.point(key.parent)};
}

std::optional<TransitionKey> Coordinator::keyOf(std::uint32_t space, const wire::Point& target,
                                                const wire::Point& parent) const {
  if (space >= plans_.size()) return std::nullopt;
  const Lattice& positions = plans_[space].positions();
  const auto to = positions.indexOf(fromWire(target)), from = positions.indexOf(fromWire(parent));
  if (!to || !from) return std::nullopt;
  return TransitionKey{space, *to, *from};
}

bool Coordinator::deserted(Time now) const {
  // Workers that are drained leave without a word when the build is complete.
  return std::ranges::all_of(registry_.all(), [&](const auto& entry) {
    return now - entry.second.heard > 3 * settings_.heartbeat;
  });
}

void Coordinator::finishIfComplete(Time now) {
  if (complete() || !std::ranges::all_of(plans_, &SpacePlan::complete)) return;
  openChecks();
  forgetChecksOfNothing();
  if (checks_.openCount() + due_checks_.size() > 0) return;
  PALPATE_ASSERT(group_.size() == 0 && leases_.empty(),
                 "a complete plan waits for no result, and nobody solves for it");
  complete_ = true;
  changed_.clear();
  chronicle_.completed(recorded_, std::chrono::duration<double>(now - started_).count());
  store_->tables().showAll(plans_);
  writeServers(now);
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

void Coordinator::advance(Time now, bool all_read) {
  noteOwnGap(now);
  if (!begins_anew_.empty()) {
    // Whoever asked for it hears of it first.
    if (std::exchange(answered_, true)) throw FailuresRetried(begins_anew_);
    return;
  }
  if (all_read) {
    takeBackFromTheIdle(now);
    takeBackForTheIdle(now);
    probeSilentWorkers(now);
    loseSilentWorkers(now);
  }
  if (groupIsDue(now)) commitGroup(now);
  handOutJobs(now);
  giveUpChecks(now);
  if (!changed_.empty() && now - changed_since_ >= settings_.tables_age) showChanged();
  if (now >= serversDue()) writeServers(now);
  pace_.note(now, converged_);
  work_pace_.note(now, recorded_);
  lookAhead(now);
  chronicle_.flush();
}

/// Now and then: every point is looked at.
void Coordinator::lookAhead(Time now) {
  constexpr std::chrono::milliseconds at_least{500};
  if (complete_ || now - forecast_made_ < at_least) return;
  // Twenty microseconds for what costs a fifth of one.
  double points = 0;
  for (const SpacePlan& plan : plans_) points += plan.size();
  if (now - forecast_made_ < std::chrono::duration<double>(2e-5 * points)) return;
  forecast_ = forecastOf(*problem_, plans_);
  forecast_made_ = now;
  recorded_then_ = recorded_;
}

Coordinator::Time Coordinator::nextDeadline() const {
  Time deadline = serversDue();
  if (group_.since()) deadline = std::min(deadline, *group_.since() + settings_.group_age);
  if (!changed_.empty()) deadline = std::min(deadline, changed_since_ + settings_.tables_age);
  for (const auto& [id, worker] : registry_.all()) {
    deadline = std::min(deadline, worker.heard + settings_.worker_lost);
    if (worker.idle_since)
      deadline = std::min(deadline, *worker.idle_since + settings_.idle_with_leases);
  }
  return deadline;
}

/// Of what it may hold.
std::size_t Coordinator::roomOf(const Worker& worker) const {
  const std::size_t most = allotment_.limitOf(worker, last_turn_);
  return most - std::min(most, leases_.leasedTo(worker.id));
}

/// To the workers that hold least, so that all have something when there is little, and first to
/// those that are known to do what they are given.
void Coordinator::handOutJobs(Time now) {
  const bool checks_wait = !leases_.waitingChecks().empty();
  if (!handsOut() || (leases_.waiting() == 0 && !checks_wait)) return;
  const std::map<TransitionKey, Apart> wanted = wantedOfChecks();
  // Newcomer, targets it holds; of newcomers those first that were given nothing for longest.
  using Load = std::tuple<bool, std::size_t, Time, std::string>;
  std::set<Load> by_load;
  const auto queue = [&](const Worker& worker) {
    if (worker.credit > 0 && roomOf(worker) > 0)
      by_load.emplace(worker.earned == 0, leases_.leasedTo(worker.id),
                      worker.earned == 0 ? worker.moved : Time(), worker.id);
  };
  for (const auto& [id, worker] : registry_.all()) queue(worker);
  while (!by_load.empty()) {
    const std::string id = std::get<std::string>(by_load.extract(by_load.begin()).value());
    Worker& worker = registry_.at(id);
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
    queue(worker);
    sendJob(worker, *handout);
  }
}

/// When nothing waits, and somebody who is known to work has nothing to do, what others do not come
/// to is put back, the last first. Whoever finds it first is right, as always.
void Coordinator::takeBackForTheIdle(Time now) {
  if (!handsOut() || leases_.waiting() > 0) return;
  const bool all_are_new = std::ranges::none_of(
      registry_.all(), [](const auto& entry) { return entry.second.earned > 0; });
  auto idle = std::ranges::count_if(registry_.all(), [&](const auto& entry) {
    const Worker& worker = entry.second;
    return worker.credit > 0 && (worker.earned > 0 || all_are_new) &&
           leases_.leasedTo(worker.id) == 0 && roomOf(worker) > 0;
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

void Coordinator::sendJob(const Worker& worker, const Handout& handout) {
  const SpacePlan& plan = plans_[handout.space];
  PALPATE_ASSERT(!handout.targets.empty(), "a hand-out without targets would be no job");
  wire::Job& job = *send(worker.peer).mutable_job();
  job.set_id(handout.job);  // which heartbeats name
  job.set_hung_after_s(static_cast<std::uint32_t>(hungAfter().count()));
  job.set_space(handout.space);
  *job.mutable_start() = toWire(plan.positions().point(handout.parent));
  // Whatever goes to several targets is none of the rest state, which has a job of its own.
  const TransitionKey first = {handout.space, handout.targets.front().point, handout.parent};
  const bool is_check = checks_.isOpen(resultKeyOf(first));
  job.set_start_id(is_check ? checks_.startOf(resultKeyOf(first)).id
                            : startIdOf(plan, {first.target, first.parent}));
  for (const Handout::Target& target : handout.targets) {
    wire::Target& entry = *job.add_targets();
    *entry.mutable_point() = toWire(plan.positions().point(target.point));
    entry.set_attempt(target.attempt);
    const ResultKey key = resultKeyOf({handout.space, target.point, handout.parent});
    entry.set_lease(seal_.sealOf({worker.id, key, job.start_id()}));
    entry.set_steps(is_check
                        ? checks_.startOf(key).steps
                        : static_cast<std::uint32_t>(plan.stepsOf({target.point, handout.parent})));
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

void Coordinator::takeBackFromTheIdle(Time now) {
  for (auto& [id, worker] : registry_.all()) {
    if (!worker.idle_since || now - *worker.idle_since < settings_.idle_with_leases) continue;
    peer_log_.warn(now, "worker {} on {} does not solve what it was given: it is handed out again",
                   worker.pid, worker.host);
    worker.addCredit(leases_.jobsOf(id).size());
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
  keys_heard_[worker.provenance.key()] = now;
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
    const auto& [space, target, parent] = resultKeyOf(key);
    spdlog::error(
        "space {}, point ({}, {}, {}) from ({}, {}, {}): {} workers ended while they solved it; it "
        "is set aside, and the rest goes on without it",
        space, target[0], target[1], target[2], parent[0], parent[1], parent[2], losses.deaths);
  }
}

std::int32_t Coordinator::retry() {
  const auto aside = static_cast<std::int32_t>(leases_.aside().size());
  leases_.retry();
  losses_.clear();
  store_->tables().forgetLosses();
  chronicle_.retried(aside);
  return aside;
}

/// The plans are made anew without them, and ask for them again.
std::int32_t Coordinator::retryFailed(const std::string& cause) {
  const auto which = causeNamed(cause);
  if (!which || !begins_anew_.empty()) return 0;
  const std::vector<ResultKey> failed = failedWith(plans_, *which);
  if (failed.empty()) return 0;
  store_->drop(failed);
  chronicle_.retried(std::ssize(failed), cause);
  begins_anew_ =
      fmt::format("{} attempts that failed with {} are tried again, as an operator asked",
                  failed.size(), cause);
  return static_cast<std::int32_t>(failed.size());
}

/// Why that cannot be; empty when it is so now.
std::string Coordinator::prioritize(const std::string& name, std::int32_t priority) {
  std::set<std::string> names;
  for (std::uint32_t space = 0; space < plans_.size(); ++space) {
    const std::string& row = *names.insert(rowNameOf(problem_->scene.active[space])).first;
    if (row == name) leases_.setPriority(space, priority);
  }
  if (!names.contains(name))
    return fmt::format("no space is called {}: they are {}", printable(name),
                       printable(fmt::format("{}", fmt::join(names, ", ")), 500));
  priorities_[name] = priority;
  recent_status_.clear();
  return "";
}

void Coordinator::pause(bool paused) {
  if (paused == paused_) return;
  store_->tables().writePaused(paused);
  paused_ = paused;
  recent_status_.clear();
  chronicle_.paused(paused);
  spdlog::info(paused ? "paused: nothing is handed out before palpate resume" : "going on");
}

void Coordinator::stop(Time now) {
  if (stopping_) return;
  // Before the workers hear of it: their acknowledgements go out first.
  commitGroup(now);
  stopping_ = true;
  showChanged();
  drainAll();
  writeServers(now);
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
  servers_written_ = now;
  newcomers_ = false;
}

wire::Message& Coordinator::send(const std::string& peer,
                                 std::shared_ptr<const std::string> payload) {
  outbox_.push_back({peer, {}, std::move(payload)});
  return outbox_.back().message;
}

void Coordinator::drain(const std::string& peer) {
  send(peer).mutable_drain()->set_finished(complete());
}

void Coordinator::drainAll() {
  for (const auto& [id, worker] : registry_.all()) drain(worker.peer);
}

wire::ResultAck& Coordinator::acknowledgement(const std::string& peer, const wire::Result& result) {
  wire::ResultAck& ack = *send(peer).mutable_result_ack();
  ack.set_space(result.space());
  *ack.mutable_target() = result.target();
  *ack.mutable_parent() = result.parent();
  return ack;
}

const std::string& Coordinator::recentStatus(Time now) {
  // s, as it was measured: whoever asks without end costs a twentieth of a processor.
  constexpr double by_point = 4e-8, by_worker = 3e-6, times = 20;
  double cost = by_worker * static_cast<double>(registry_.all().size());
  for (const SpacePlan& plan : plans_) cost += by_point * plan.size();
  const std::chrono::duration<double> good_for(std::max(0.02, times * cost));
  if (recent_status_.empty() || now - recent_status_made_ >= good_for) {
    recent_status_ = toJson(status(now));
    recent_status_made_ = now;
  }
  return recent_status_;
}

void Coordinator::addTimeLeft(wire::Status& status, Time now) const {
  if (complete()) {
    status.set_eta_seconds(0);
    return;
  }
  const double rate = work_pace_.perSecond(now, recorded_);
  if (rate <= 0 || paused_) return;
  // Results since then were among what was ready.
  const double ready =
      std::max(1.0, forecast_.ready - static_cast<double>(recorded_ - recorded_then_));
  status.set_eta_seconds((ready + forecast_.expected) / rate);
  status.set_eta_low_seconds((ready + forecast_.expected / 2) / rate);
  status.set_eta_high_seconds((ready + 2 * forecast_.expected) / rate);
}

wire::Status Coordinator::status(Time now) const {
  wire::Status status = statusOf(*problem_, plans_, registry_.rows(leases_, now), counters_);
  status.set_build(build_.hex());
  status.set_set_aside(static_cast<std::int32_t>(asideCount()));
  status.set_checks_open(static_cast<std::int32_t>(checks_.openCount() + due_checks_.size()));
  status.set_disputed(static_cast<std::int32_t>(checks_.disputedCount()));
  addKeptOut(status, store_->keptOut());
  addDisk(status, store_->directory(), store_->journalBytes());
  status.set_state(complete() ? "complete" : stopping_ ? "stopping" : "running");
  status.set_paused(paused_);
  status.set_kernel_family(registry_.kernelFamily());
  setPriorities(status, priorities_);
  status.set_recorded(static_cast<std::int32_t>(recorded_));
  status.set_seconds(std::chrono::duration<double>(now - started_).count());
  const double rate = pace_.perSecond(now, converged_);
  status.set_configurations_per_second(rate);
  addTimeLeft(status, now);
  return status;
}

}  // namespace palpate
