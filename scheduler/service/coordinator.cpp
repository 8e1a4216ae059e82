#include "scheduler/service/coordinator.hpp"

#include <sodium.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "scheduler/state/replay.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds servers_written_every{5};
/// Of a flood of bad messages the first ones tell what there is to tell.
constexpr std::int64_t bad_messages_logged = 20;

std::string randomBytes(std::size_t count) {
  if (sodium_init() < 0) throw failure("libsodium could not be initialised");
  std::string bytes(count, '\0');
  randombytes_buf(bytes.data(), bytes.size());
  return bytes;
}

}  // namespace

Coordinator::Coordinator(const Problem& problem, std::string problem_bytes, JobStore& store,
                         Journal& journal, Time now, CoordinatorSettings settings)
    : problem_(&problem),
      problem_bytes_(std::make_shared<const std::string>(std::move(problem_bytes))),
      build_(problemId(problem)),
      check_(problem),
      store_(&store),
      journal_(&journal),
      settings_(settings),
      incarnation_(randomBytes(16)),
      registry_(store.build().kernel_family),
      group_(store, journal),
      counters_(store.counters()),
      started_(now),
      servers_written_(now),
      pace_(now) {
  ++counters_["runs"];
  // The upper half of a job number is the run, so that two runs never use the same.
  leases_ = Leases(static_cast<std::uint64_t>(counters_["runs"]) << 32);
  const std::vector<StoredResult> results = store_->results();
  found_ = results.size();
  Replay replayed = replay(problem, results);
  plans_ = std::move(replayed.plans);
  PALPATE_ASSERT(plans_.size() == problem.active.size(), "every active node has its plan");
  for (const TransitionKey& key : replayed.missing) leases_.add(key);
  store_->writeCounters(counters_);
  finishIfComplete(now);
}

void Coordinator::receive(const Incoming& incoming, Time now) {
  const wire::Message& message = incoming.message;
  const std::string& peer = incoming.peer;
  if (message.has_hello()) return hello(peer, message.hello(), now);
  if (message.has_status_request())
    return send(peer).mutable_status_reply()->set_json(toJson(status(now)));
  if (message.has_stop_request()) {
    send(peer).mutable_stop_reply()->set_stopping(true);
    return stop(now);
  }
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
  if (message.has_problem_request()) return sendProblem(*worker);
  if (message.has_request()) return request(*worker, message.request());
  if (message.has_fields_request()) return sendFields(*worker, message.fields_request());
  if (message.has_result()) return result(*worker, incoming, now);
  if (message.has_heartbeat()) return heartbeat(*worker, message.heartbeat(), now);
  if (message.has_goodbye()) return goodbye(*worker, message.goodbye(), now);
  badMessage(peer, "workers do not send that");
}

void Coordinator::hello(const std::string& peer, const wire::Hello& hello, Time now) {
  if (const std::string objection = registry_.objectionTo(hello); !objection.empty()) {
    spdlog::warn("worker {} on {} was refused: {}", hello.pid(), hello.host(), objection);
    ++counters_["refused_workers"];
    send(peer).mutable_refused()->set_reason(objection);
    return;
  }
  if (const Worker* before = registry_.ofPeer(peer); before && before->id != hello.worker()) {
    leases_.giveBack(before->id);
    registry_.remove(*before, "left", now);
  }
  // A worker that introduces itself again has forgotten what it was given.
  leases_.giveBack(hello.worker());
  const Worker& worker = registry_.admit(peer, hello, now);
  spdlog::info("worker {} on {} joined ({} kernels)", worker.pid, worker.host,
               worker.kernel_family);
  servers_written_ = now - servers_written_every;  // the tables name it from the next turn on

  wire::Welcome& welcome = *send(peer).mutable_welcome();
  welcome.set_incarnation(incarnation_);
  welcome.set_build(std::string(build_.bytes()));
  welcome.set_heartbeat_ms(static_cast<std::uint32_t>(settings_.heartbeat.count()));
  if (stopping_ || complete()) drain(peer);
}

void Coordinator::goodbye(Worker& worker, const wire::Goodbye& goodbye, Time now) {
  spdlog::info("worker {} on {} left: {}", worker.pid, worker.host, goodbye.reason());
  leases_.giveBack(worker.id);
  registry_.remove(worker, "left", now);
}

void Coordinator::request(Worker& worker, const wire::Request& request) {
  // It may have missed the first word to leave.
  if (stopping_ || complete()) return drain(worker.peer);
  worker.addCredit(request.credit());
}

void Coordinator::sendProblem(const Worker& worker) {
  wire::ProblemReply& reply = *send(worker.peer, problem_bytes_).mutable_problem_reply();
  reply.set_build(std::string(build_.bytes()));
  reply.set_payload_bytes(static_cast<std::uint32_t>(problem_bytes_->size()));
}

void Coordinator::sendFields(const Worker& worker, const wire::FieldsRequest& request) {
  std::optional<StoredResult> found;
  if (const auto key = keyOf(request.space(), request.point(), request.point()))
    if (const PointRecord& point = plans_[key->space].point(key->target); isSolved(point.tag))
      found = store_->find({key->space, key->target, point.parent});
  // The point may have another equilibrium by now than the one the job started from.
  const bool known = found && found->header.fields_id() == request.id();
  std::shared_ptr<const std::string> payload;
  if (known) payload = std::make_shared<const std::string>(journal_->read(found->where).payload);
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
  if (stopping_ || complete()) drain(worker.peer);
}

void Coordinator::result(Worker& worker, const Incoming& incoming, Time now) {
  const wire::Result& message = incoming.message.result();
  // Who delivers is at work, whatever its last heartbeat said.
  worker.idle_since.reset();
  if (const std::string objection =
          check_.objectionTo(message, incoming.payload, registry_.kernelFamily());
      !objection.empty())
    return badMessage(worker.peer, objection);
  const auto key = keyOf(message.space(), message.target(), message.parent());
  if (!key) return badMessage(worker.peer, "a result for a point that does not exist");
  ResultGroup::Member* waiting = group_.find(*key);
  if (waiting != nullptr) {
    duplicate(worker, waiting->result.header, message);
  } else if (plans_[key->space].isOpen({key->target, key->parent})) {
    ++worker.results;
    leases_.finish(*key);
    group_.add({*key, message, *fromWire(message), {}}, incoming.payload, now);
    waiting = group_.find(*key);
  } else if (const auto recorded = store_->find(*key)) {
    // Its acknowledgement was lost, or a worker taken for dead finished after all.
    duplicate(worker, recorded->header, message);
    return acknowledge(worker.peer, message);
  } else {
    return badMessage(worker.peer, "nobody asked for this result");
  }
  waiting->senders.insert(worker.peer);
  if (group_.size() >= settings_.group_results) commitGroup(now);
}

void Coordinator::duplicate(const Worker& worker, const wire::Result& first,
                            const wire::Result& second) {
  ++counters_["duplicate_results"];
  if (ResultCheck::agree(first, second)) return;
  ++counters_["divergent_results"];
  spdlog::error(
      "space {}, point ({}, {}, {}): worker {} on {} found other bits than the recorded ones; "
      "the first result is kept. One of the two machines computes wrongly",
      second.space(), second.target().i(), second.target().j(), second.target().k(), worker.pid,
      worker.host);
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
  if (group_.size() == 0) return;
  // Plans move on only after this: what they ask for next may rest on what is in the group.
  const ResultGroup::Members durable = group_.commit();
  for (const auto& [key, member] : durable) {
    for (const std::string& peer : member.senders) acknowledge(peer, member.result.header);
    SpacePlan& plan = plans_[key.space];
    plan.record({key.target, key.parent}, member.result.outcome, fieldsOf(member.result.header));
    ++recorded_;
    converged_ += member.result.outcome.converged;
    for (const Transition& ready : plan.takeReady())
      leases_.add({key.space, ready.target, ready.parent});
  }
  finishIfComplete(now);
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

bool Coordinator::complete() const { return store_->build().complete; }

void Coordinator::finishIfComplete(Time now) {
  if (complete() || !std::ranges::all_of(plans_, &SpacePlan::complete)) return;
  PALPATE_ASSERT(group_.size() == 0 && leases_.empty(),
                 "a complete plan waits for no result, and nobody solves for it");
  store_->complete(plans_);
  writeServers(now);
  drainAll();
}

void Coordinator::advance(Time now) {
  takeBackFromTheIdle(now);
  loseSilentWorkers(now);
  if (groupIsDue(now)) commitGroup(now);
  handOutJobs();
  if (now - servers_written_ >= servers_written_every) writeServers(now);
  pace_.note(now, converged_);
}

Coordinator::Time Coordinator::nextDeadline() const {
  Time deadline = servers_written_ + servers_written_every;
  if (group_.since()) deadline = std::min(deadline, *group_.since() + settings_.group_age);
  for (const auto& [id, worker] : registry_.all()) {
    deadline = std::min(deadline, worker.heard + settings_.worker_lost);
    if (worker.idle_since)
      deadline = std::min(deadline, *worker.idle_since + settings_.idle_with_leases);
  }
  return deadline;
}

/// To the workers that hold least, so that all have something when there is little.
void Coordinator::handOutJobs() {
  if (stopping_ || complete() || leases_.waiting() == 0) return;
  using Load = std::pair<std::size_t, std::string>;  // targets it holds, id
  std::set<Load> by_load;
  for (const auto& [id, worker] : registry_.all())
    if (worker.credit > 0) by_load.emplace(leases_.leasedTo(id), id);
  while (!by_load.empty()) {
    const std::string id = by_load.extract(by_load.begin()).value().second;
    const auto handout = leases_.handOut(id, registry_.all().size());
    if (!handout) return;
    Worker& worker = registry_.at(id);
    PALPATE_ASSERT(worker.credit > 0, "only workers that asked for a job are in the list");
    worker.idle_since.reset();
    if (--worker.credit > 0) by_load.emplace(leases_.leasedTo(id), id);
    sendJob(worker.peer, *handout);
  }
}

void Coordinator::sendJob(const std::string& peer, const Handout& handout) {
  const SpacePlan& plan = plans_[handout.space];
  PALPATE_ASSERT(!handout.targets.empty(), "a hand-out without targets would be no job");
  wire::Job& job = *send(peer).mutable_job();
  job.set_id(handout.job);  // which heartbeats name
  job.set_space(handout.space);
  *job.mutable_start() = toWire(plan.positions().point(handout.parent));
  // The origin is its own parent: it is solved from the rest state, which has no id.
  if (handout.targets.front().point != handout.parent) {
    const PointRecord& start = plan.point(handout.parent);
    PALPATE_ASSERT(isSolved(start.tag), "a plan asks for transitions from solved points only");
    job.set_start_id(std::string(start.fields.bytes()));
  }
  for (const Handout::Target& target : handout.targets) {
    wire::Target& entry = *job.add_targets();
    *entry.mutable_point() = toWire(plan.positions().point(target.point));
    entry.set_attempt(target.attempt);
    entry.set_steps(static_cast<std::uint32_t>(plan.stepsOf({target.point, handout.parent})));
  }
}

void Coordinator::takeBackFromTheIdle(Time now) {
  for (auto& [id, worker] : registry_.all()) {
    if (!worker.idle_since || now - *worker.idle_since < settings_.idle_with_leases) continue;
    spdlog::warn("worker {} on {} does not solve what it was given: it is handed out again",
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
  for (const Worker* worker : silent) workerDied(*worker, now, "says nothing any more");
}

void Coordinator::peerUnreachable(const std::string& peer, Time now) {
  const Worker* worker = registry_.ofPeer(peer);
  if (worker == nullptr) return;
  // Its connection broke, which says nothing about what it was solving: nobody is to blame.
  spdlog::info("worker {} on {} cannot be reached", worker->pid, worker->host);
  leases_.giveBack(worker->id);
  ++counters_["lost_workers"];
  registry_.remove(*worker, "lost", now);
}

void Coordinator::workerProcessEnded(std::uint32_t pid, Time now) {
  if (const Worker* worker = registry_.ofProcess(pid))
    workerDied(*worker, now, "ended unexpectedly");
}

void Coordinator::workerDied(const Worker& worker, Time now, const char* why) {
  spdlog::warn("worker {} on {} {}; {} targets are handed out again", worker.pid, worker.host, why,
               leases_.leasedTo(worker.id));
  // The worker goes with its registration, so its leases are ended first.
  const std::vector<TransitionKey> given_up = leases_.workerDied(worker.id, worker.solving);
  ++counters_["lost_workers"];
  registry_.remove(worker, "lost", now);
  for (const TransitionKey& key : given_up) giveUp(key, now);
}

void Coordinator::giveUp(const TransitionKey& key, Time now) {
  const Lattice& positions = plans_[key.space].positions();
  const LatticePoint& point = positions.point(key.target);
  spdlog::error(
      "space {}, point ({}, {}, {}): {} workers died while they solved it; "
      "it is not tried from there again",
      key.space, point[0], point[1], point[2], deaths_before_giving_up);
  Outcome outcome;
  outcome.failure.cause = Cause::worker_lost;
  // Recorded as if a worker had said so: a restart must not try it five times again.
  wire::Result header;
  header.set_build(std::string(build_.bytes()));
  header.set_space(key.space);
  *header.mutable_target() = toWire(point);
  *header.mutable_parent() = toWire(positions.point(key.parent));
  header.set_kernel_family(registry_.kernelFamily());
  toWire(outcome, "", header);
  leases_.finish(key);
  group_.add({key, header, outcome, {}}, "", now);
}

void Coordinator::stop(Time now) {
  if (stopping_) return;
  // Before the workers hear of it: their acknowledgements go out first.
  commitGroup(now);
  stopping_ = true;
  drainAll();
  writeServers(now);
}

void Coordinator::writeServers(Time now) {
  std::vector<wire::WorkerStatus> rows = registry_.takeDeparted();
  const std::vector<wire::WorkerStatus> present = registry_.rows(leases_, now);
  rows.insert(rows.end(), present.begin(), present.end());
  store_->writeServers(rows);
  store_->writeCounters(counters_);
  servers_written_ = now;
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

void Coordinator::acknowledge(const std::string& peer, const wire::Result& result) {
  wire::ResultAck& ack = *send(peer).mutable_result_ack();
  ack.set_space(result.space());
  *ack.mutable_target() = result.target();
  *ack.mutable_parent() = result.parent();
}

wire::Status Coordinator::status(Time now) const {
  wire::Status status = statusOf(*problem_, plans_, registry_.rows(leases_, now), counters_);
  status.set_build(build_.hex());
  status.set_state(complete() ? "complete" : stopping_ ? "stopping" : "running");
  status.set_recorded(static_cast<std::int32_t>(recorded_));
  status.set_seconds(std::chrono::duration<double>(now - started_).count());
  const double rate = pace_.perSecond(now, converged_);
  status.set_configurations_per_second(rate);
  std::int64_t unknown = 0;
  for (const wire::SpaceStatus& space : status.spaces()) unknown += space.unknown();
  // Points that are solved again to tell branches apart are not counted in advance: while they are
  // all that is left, there is nothing to judge by.
  if (complete())
    status.set_eta_seconds(0);
  else if (rate > 0 && unknown > 0)
    status.set_eta_seconds(static_cast<double>(unknown) / rate);
  return status;
}

}  // namespace palpate
