#include "scheduler/coordinator.hpp"

#include <sodium.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "common/base/program.hpp"
#include "scheduler/state/replay.hpp"
#include "scheduler/status.hpp"

namespace palpate {
namespace {

using std::chrono::duration;
using std::chrono::seconds;

constexpr std::uint32_t largest_credit = 64;
constexpr seconds servers_written_every{5};
constexpr seconds rate_window{120};
constexpr std::int64_t bad_messages_logged = 20;

std::string randomBytes(std::size_t count) {
  if (sodium_init() < 0) throw failure("libsodium could not be initialised");
  std::string bytes(count, '\0');
  randombytes_buf(bytes.data(), bytes.size());
  return bytes;
}

std::string hexOf(const std::string& bytes) {
  std::string hex;
  for (const char c : bytes) hex += fmt::format("{:02x}", static_cast<unsigned char>(c));
  return hex;
}

double secondsBetween(Coordinator::Time from, Coordinator::Time to) {
  return duration<double>(to - from).count();
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
      kernel_family_(store.build().kernel_family),
      counters_(store.counters()),
      started_(now),
      servers_written_(now) {
  ++counters_["runs"];
  // The upper half of a job number is the run, so that two runs never use the same.
  leases_ = Leases(static_cast<std::uint64_t>(counters_["runs"]) << 32);
  const std::vector<StoredResult> results = store_->results();
  found_ = results.size();
  Replay replayed = replay(problem, results);
  plans_ = std::move(replayed.plans);
  for (const TransitionKey& key : replayed.open) leases_.add(key);
  progress_.emplace_back(now, 0);
  store_->writeCounters(counters_);
  finishIfComplete(now);
}

void Coordinator::receive(const Incoming& incoming, Time now) {
  const wire::Message& message = incoming.message;
  const std::string& peer = incoming.peer;
  switch (message.body_case()) {
    case wire::Message::kHello:
      return hello(peer, message.hello(), now);
    case wire::Message::kStatusRequest:
      send(peer).mutable_status_reply()->set_json(toJson(status(now)));
      return;
    case wire::Message::kStopRequest:
      send(peer).mutable_stop_reply()->set_stopping(true);
      return stop(now);
    default:
      break;
  }
  const auto found = workerOf(peer);
  if (found == workers_.end()) {
    if (message.body_case() == wire::Message::BODY_NOT_SET)
      return badMessage(peer, "it cannot be read");
    return sayUnknown(peer);
  }
  Worker& worker = found->second;
  worker.heard = now;
  switch (message.body_case()) {
    case wire::Message::kProblemRequest:
      return sendProblem(peer);
    case wire::Message::kRequest:
      return request(worker, message.request());
    case wire::Message::kFieldsRequest:
      return sendFields(peer, message.fields_request());
    case wire::Message::kResult:
      return result(peer, worker, incoming, now);
    case wire::Message::kHeartbeat:
      return heartbeat(found->first, worker, message.heartbeat(), now);
    case wire::Message::kGoodbye:
      spdlog::info("worker {} on {} left: {}", worker.pid, worker.host, message.goodbye().reason());
      leases_.giveBack(found->first);
      return removeWorker(found, "left", now);
    default:
      return badMessage(peer, "workers do not send that");
  }
}

void Coordinator::hello(const std::string& peer, const wire::Hello& hello, Time now) {
  const auto refuse = [&](const std::string& reason) {
    spdlog::warn("worker {} on {} was refused: {}", hello.pid(), hello.host(), reason);
    ++counters_["refused_workers"];
    send(peer).mutable_refused()->set_reason(reason);
  };
  if (hello.protocol() != protocol_version)
    return refuse(
        fmt::format("this scheduler speaks protocol {}, the worker protocol {}: "
                    "install the same Palpate on both",
                    protocol_version, hello.protocol()));
  if (hello.version() != version())
    return refuse(
        fmt::format("this scheduler is palpate {}, the worker palpate {}: "
                    "results of two versions may differ, so install the same on both",
                    version(), hello.version()));
  if (hello.worker().empty() || hello.worker().size() > 64)
    return refuse("its id is missing or too long");
  if (hello.kernel_family().empty()) return refuse("it does not say which kernel family it uses");
  if (kernel_family_.empty()) kernel_family_ = hello.kernel_family();
  if (hello.kernel_family() != kernel_family_)
    return refuse(fmt::format(
        "this build is computed with the {} kernels, the worker would use {}, "
        "and the last bits would depend on who solved what: use machines with {} in this build, "
        "or see PALPATE_KERNELS and OPENBLAS_CORETYPE in docs/solver.md",
        kernel_family_, hello.kernel_family(), kernel_family_));

  if (const auto before = workerOf(peer);
      before != workers_.end() && before->first != hello.worker()) {
    leases_.giveBack(before->first);
    removeWorker(before, "left", now);
  }
  // A worker that introduces itself again has forgotten what it was given.
  leases_.giveBack(hello.worker());
  Worker& worker = workers_[hello.worker()];
  if (!worker.peer.empty()) id_of_peer_.erase(worker.peer);
  worker.peer = peer;
  worker.host = hello.host();
  worker.pid = hello.pid();
  worker.kernel_family = hello.kernel_family();
  worker.credit = 0;
  worker.solving.reset();
  worker.idle_since.reset();
  worker.heard = now;
  id_of_peer_[peer] = hello.worker();
  spdlog::info("worker {} on {} joined ({} kernels)", worker.pid, worker.host,
               worker.kernel_family);
  servers_written_ = now - servers_written_every;  // the tables name it from the next turn on

  wire::Welcome& welcome = *send(peer).mutable_welcome();
  welcome.set_incarnation(incarnation_);
  welcome.set_build(std::string(build_.bytes()));
  welcome.set_heartbeat_ms(static_cast<std::uint32_t>(settings_.heartbeat.count()));
  if (stopping_ || complete()) drain(peer);
}

void Coordinator::request(Worker& worker, const wire::Request& request) {
  if (stopping_ || complete()) return drain(worker.peer);
  worker.credit =
      std::min(largest_credit, worker.credit + std::min(request.credit(), largest_credit));
}

void Coordinator::sendProblem(const std::string& peer) {
  wire::ProblemReply& reply = *send(peer, problem_bytes_).mutable_problem_reply();
  reply.set_build(std::string(build_.bytes()));
  reply.set_payload_bytes(static_cast<std::uint32_t>(problem_bytes_->size()));
}

void Coordinator::sendFields(const std::string& peer, const wire::FieldsRequest& request) {
  std::optional<StoredResult> found;
  if (const auto key = keyOf(request.space(), request.point(), request.point()))
    found = configuration(key->space, key->target);
  if (!found || found->header.fields_id() != request.id()) {
    wire::FieldsReply& reply = *send(peer).mutable_fields_reply();
    reply.set_id(request.id());
    reply.set_unknown(true);
    return;
  }
  auto payload = std::make_shared<const std::string>(journal_->read(found->where).payload);
  wire::FieldsReply& reply = *send(peer, payload).mutable_fields_reply();
  reply.set_id(request.id());
  reply.set_payload_bytes(static_cast<std::uint32_t>(payload->size()));
}

void Coordinator::heartbeat(const std::string& id, Worker& worker, const wire::Heartbeat& heartbeat,
                            Time now) {
  worker.solving.reset();
  if (heartbeat.solving()) {
    worker.idle_since.reset();
    if (const auto space = leases_.spaceOf(id, heartbeat.job()))
      if (const auto key = keyOf(*space, heartbeat.target(), heartbeat.target()))
        worker.solving = leases_.leasedTransition(id, heartbeat.job(), key->target);
  } else if (leases_.leasedTo(id) > 0 && !worker.idle_since) {
    worker.idle_since = now;
  }
  send(worker.peer).mutable_heartbeat_reply()->set_incarnation(incarnation_);
  if (stopping_ || complete()) drain(worker.peer);
}

void Coordinator::result(const std::string& peer, Worker& worker, const Incoming& incoming,
                         Time now) {
  const wire::Result& message = incoming.message.result();
  worker.idle_since.reset();
  if (const std::string objection = check_.objectionTo(message, incoming.payload, kernel_family_);
      !objection.empty())
    return badMessage(peer, objection);
  const auto named = keyOf(message.space(), message.target(), message.parent());
  if (!named) return badMessage(peer, "a result for a point that does not exist");
  const TransitionKey& key = *named;
  if (const auto waiting = group_.find(key); waiting != group_.end()) {
    duplicate(peer, waiting->second.result.header, message);
    waiting->second.peers.insert(peer);
    return;
  }
  if (plans_[key.space].isOpen({key.target, key.parent})) {
    ++worker.results;
    return enqueue({key, message, *fromWire(message), {}}, incoming.payload, peer, now);
  }
  if (const auto recorded = store_->find(key)) {
    duplicate(peer, recorded->header, message);
    return acknowledge(peer, message);
  }
  badMessage(peer, "nobody asked for this result");
}

void Coordinator::duplicate(const std::string& peer, const wire::Result& first,
                            const wire::Result& second) {
  ++counters_["duplicate_results"];
  if (ResultCheck::agree(first, second)) return;
  ++counters_["divergent_results"];
  const auto worker = workerOf(peer);
  spdlog::error(
      "space {}, point ({}, {}, {}): worker {} on {} found other bits than the recorded ones; "
      "the first result is kept. One of the two machines computes wrongly",
      second.space(), second.target().i(), second.target().j(), second.target().k(),
      worker->second.pid, worker->second.host);
}

void Coordinator::badMessage(const std::string& peer, const std::string& why) {
  if (++counters_["bad_messages"] > bad_messages_logged) return;
  const auto worker = workerOf(peer);
  if (worker == workers_.end())
    spdlog::warn("a message from a stranger was dropped: {}", why);
  else
    spdlog::warn("a message from worker {} on {} was dropped: {}", worker->second.pid,
                 worker->second.host, why);
}

void Coordinator::enqueue(StoredResult result, std::string payload, const std::string& peer,
                          Time now) {
  const TransitionKey key = result.key;
  leases_.finish(key);
  Pending& pending = group_[key];
  pending.result = std::move(result);
  pending.payload = std::move(payload);
  if (!peer.empty()) pending.peers.insert(peer);
  if (!group_since_) group_since_ = now;
  if (group_.size() >= settings_.group_results) commitGroup(now);
}

bool Coordinator::groupIsDue(Time now) const {
  if (group_.empty()) return false;
  if (now - *group_since_ >= settings_.group_age) return true;
  // Somebody waits for what these results may make ready.
  return leases_.waiting() == 0 &&
         std::any_of(workers_.begin(), workers_.end(),
                     [](const auto& entry) { return entry.second.credit > 0; });
}

void Coordinator::commitGroup(Time now) {
  if (group_.empty()) return;
  std::vector<StoredResult> results;
  std::vector<Tag> tags;
  for (auto& [key, pending] : group_) {
    pending.result.where =
        journal_->append(pending.result.header.SerializeAsString(), pending.payload);
    results.push_back(pending.result);
    tags.push_back(plans_[key.space].tagOf(pending.result.outcome.equilibrium.force.norm()));
  }
  journal_->sync();
  if (store_->build().kernel_family.empty()) store_->setKernelFamily(kernel_family_);
  store_->record(results, tags, journal_->end());

  const auto group = std::exchange(group_, {});
  group_since_.reset();
  for (const auto& [key, pending] : group) {
    for (const std::string& peer : pending.peers) acknowledge(peer, pending.result.header);
    recordInPlan(pending.result);
  }
  finishIfComplete(now);
}

void Coordinator::recordInPlan(const StoredResult& result) {
  plans_[result.key.space].record({result.key.target, result.key.parent}, result.outcome,
                                  fieldsOf(result.header));
  ++recorded_;
  converged_ += result.outcome.converged;
  addReady(result.key.space);
}

void Coordinator::addReady(std::uint32_t space) {
  for (const Transition& transition : plans_[space].takeReady())
    leases_.add({space, transition.target, transition.parent});
}

std::optional<TransitionKey> Coordinator::keyOf(std::uint32_t space, const wire::Point& target,
                                                const wire::Point& parent) const {
  if (space >= plans_.size()) return std::nullopt;
  const Lattice& positions = plans_[space].positions();
  const auto to = positions.indexOf(fromWire(target)), from = positions.indexOf(fromWire(parent));
  if (!to || !from) return std::nullopt;
  return TransitionKey{space, *to, *from};
}

std::optional<StoredResult> Coordinator::configuration(std::uint32_t space,
                                                       std::int32_t point) const {
  const PointRecord& record = plans_[space].record(point);
  if (!isSolved(record.tag)) return std::nullopt;
  return store_->find({space, point, record.parent});
}

bool Coordinator::deserted(Time now) const {
  return std::all_of(workers_.begin(), workers_.end(), [&](const auto& entry) {
    return now - entry.second.heard > 3 * settings_.heartbeat;
  });
}

bool Coordinator::complete() const { return store_->build().complete; }

void Coordinator::finishIfComplete(Time now) {
  if (complete() || !group_.empty()) return;
  if (!std::all_of(plans_.begin(), plans_.end(),
                   [](const SpacePlan& plan) { return plan.complete(); }))
    return;
  std::vector<FailedPoints> failed(plans_.size());
  for (std::size_t space = 0; space < plans_.size(); ++space)
    for (std::int32_t n = 0; n < plans_[space].size(); ++n)
      if (const PointRecord& record = plans_[space].record(n); record.tag == Tag::failed)
        failed[space][n] = {plans_[space].positions().point(n), record.cause};
  store_->complete(failed);
  writeServers(now);
  for (const auto& [id, worker] : workers_) drain(worker.peer);
}

void Coordinator::advance(Time now) {
  loseSilentWorkers(now);
  if (groupIsDue(now)) commitGroup(now);
  handOutJobs();
  if (now - servers_written_ >= servers_written_every) writeServers(now);
  noteProgress(now);
}

Coordinator::Time Coordinator::nextDeadline() const {
  Time deadline = servers_written_ + servers_written_every;
  if (group_since_) deadline = std::min(deadline, *group_since_ + settings_.group_age);
  for (const auto& [id, worker] : workers_) {
    deadline = std::min(deadline, worker.heard + settings_.worker_lost);
    if (worker.idle_since)
      deadline = std::min(deadline, *worker.idle_since + settings_.idle_with_leases);
  }
  return deadline;
}

void Coordinator::handOutJobs() {
  if (stopping_ || complete()) return;
  if (leases_.waiting() == 0) return;
  std::set<std::pair<std::size_t, std::string>>
      by_load;  // (targets it holds, id) of workers with credit
  for (const auto& [id, worker] : workers_)
    if (worker.credit > 0) by_load.emplace(leases_.leasedTo(id), id);
  while (!by_load.empty()) {
    const std::string id = by_load.extract(by_load.begin()).value().second;
    const auto handout = leases_.handOut(id, workers_.size());
    if (!handout) return;
    Worker& worker = workers_.at(id);
    worker.idle_since.reset();
    if (--worker.credit > 0) by_load.emplace(leases_.leasedTo(id), id);
    sendJob(worker.peer, *handout);
  }
}

void Coordinator::sendJob(const std::string& peer, const Handout& handout) {
  const SpacePlan& plan = plans_[handout.space];
  wire::Job& job = *send(peer).mutable_job();
  job.set_id(handout.job);
  job.set_space(handout.space);
  *job.mutable_start() = toWire(plan.positions().point(handout.parent));
  job.set_start_id(startId(handout.space, handout.parent, handout.targets.front().point));
  for (const Handout::Target& target : handout.targets) {
    wire::Target& entry = *job.add_targets();
    *entry.mutable_point() = toWire(plan.positions().point(target.point));
    entry.set_attempt(target.attempt);
    entry.set_steps(static_cast<std::uint32_t>(plan.stepsOf({target.point, handout.parent})));
  }
}

std::string Coordinator::startId(std::uint32_t space, std::int32_t parent, std::int32_t target) {
  if (parent == target) return "";  // the origin itself, from the rest state
  const PointRecord& start = plans_[space].record(parent);
  if (!isSolved(start.tag))
    throw failure("point {} of space {} is the start of a job but is not solved", parent, space);
  return std::string(start.fields.bytes());
}

void Coordinator::loseSilentWorkers(Time now) {
  std::vector<std::string> silent;
  for (auto& [id, worker] : workers_) {
    if (now - worker.heard >= settings_.worker_lost) silent.push_back(id);
    if (!worker.idle_since || now - *worker.idle_since < settings_.idle_with_leases) continue;
    spdlog::warn("worker {} on {} does not solve what it was given: it is handed out again",
                 worker.pid, worker.host);
    worker.credit = std::min<std::uint32_t>(
        largest_credit, worker.credit + static_cast<std::uint32_t>(leases_.jobsOf(id)));
    worker.idle_since.reset();
    leases_.giveBack(id);
  }
  for (const std::string& id : silent) workerDied(id, now, "says nothing any more");
}

void Coordinator::peerUnreachable(const std::string& peer, Time now) {
  const auto worker = workerOf(peer);
  if (worker == workers_.end()) return;
  // Its connection broke, which says nothing about what it was solving: nobody is to blame.
  spdlog::info("worker {} on {} cannot be reached", worker->second.pid, worker->second.host);
  leases_.giveBack(worker->first);
  ++counters_["lost_workers"];
  removeWorker(worker, "lost", now);
}

void Coordinator::workerProcessEnded(std::uint32_t pid, Time now) {
  for (const auto& [id, worker] : workers_)
    if (worker.pid == pid) return workerDied(id, now, "ended unexpectedly");
}

void Coordinator::workerDied(const std::string& id, Time now, const char* why) {
  const auto worker = workers_.find(id);
  spdlog::warn("worker {} on {} {}; {} targets are handed out again", worker->second.pid,
               worker->second.host, why, leases_.leasedTo(id));
  const std::vector<TransitionKey> given_up = leases_.workerDied(id, worker->second.solving);
  ++counters_["lost_workers"];
  removeWorker(worker, "lost", now);
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
  wire::Result header;
  header.set_build(std::string(build_.bytes()));
  header.set_space(key.space);
  *header.mutable_target() = toWire(point);
  *header.mutable_parent() = toWire(positions.point(key.parent));
  header.set_kernel_family(kernel_family_);
  toWire(outcome, "", header);
  enqueue({key, header, outcome, {}}, "", "", now);
}

void Coordinator::removeWorker(Workers::iterator worker, const char* state, Time now) {
  departed_.push_back(rowOf(worker->first, worker->second, state, now));
  id_of_peer_.erase(worker->second.peer);
  workers_.erase(worker);
}

void Coordinator::stop(Time now) {
  if (stopping_) return;
  commitGroup(now);
  stopping_ = true;
  for (const auto& [id, worker] : workers_) drain(worker.peer);
  writeServers(now);
}

void Coordinator::writeServers(Time now) {
  std::vector<ServerRow> rows = std::exchange(departed_, {});
  for (const auto& [id, worker] : workers_)
    rows.push_back(rowOf(id, worker, leases_.leasedTo(id) > 0 ? "busy" : "idle", now));
  store_->writeServers(rows);
  store_->writeCounters(counters_);
  servers_written_ = now;
}

void Coordinator::noteProgress(Time now) {
  if (now - progress_.back().first < seconds(1)) return;
  progress_.emplace_back(now, converged_);
  while (progress_.size() > 2 && now - progress_[1].first >= rate_window) progress_.pop_front();
}

ServerRow Coordinator::rowOf(const std::string& id, const Worker& worker, const char* state,
                             Time now) const {
  return {hexOf(id),  worker.host,
          worker.pid, worker.kernel_family,
          state,      secondsBetween(worker.heard, now),
          0,          worker.results};
}

std::vector<Outgoing> Coordinator::takeOutbox() { return std::exchange(outbox_, {}); }

wire::Message& Coordinator::send(const std::string& peer,
                                 std::shared_ptr<const std::string> payload) {
  outbox_.push_back({peer, {}, std::move(payload)});
  return outbox_.back().message;
}

/// An empty incarnation is never the one a worker knows, so it says hello, and then resends what
/// was not acknowledged.
void Coordinator::sayUnknown(const std::string& peer) { send(peer).mutable_heartbeat_reply(); }

void Coordinator::drain(const std::string& peer) {
  send(peer).mutable_drain()->set_finished(complete());
}

void Coordinator::acknowledge(const std::string& peer, const wire::Result& result) {
  wire::ResultAck& ack = *send(peer).mutable_result_ack();
  ack.set_space(result.space());
  *ack.mutable_target() = result.target();
  *ack.mutable_parent() = result.parent();
}

Coordinator::Workers::iterator Coordinator::workerOf(const std::string& peer) {
  const auto id = id_of_peer_.find(peer);
  return id == id_of_peer_.end() ? workers_.end() : workers_.find(id->second);
}

wire::Status Coordinator::status(Time now) const {
  wire::Status status;
  status.set_scene(problem_->scene.name);
  status.set_build(build_.hex());
  status.set_state(complete() ? "complete" : stopping_ ? "stopping" : "running");
  std::vector<std::string> names;
  for (const ActivePatch& patch : problem_->active) names.push_back(patch.name);
  addPlans(status, plans_, names);
  status.set_recorded(static_cast<std::int32_t>(recorded_));
  status.set_seconds(secondsBetween(started_, now));
  const double elapsed = secondsBetween(progress_.front().first, now);
  const double rate =
      elapsed > 0 ? static_cast<double>(converged_ - progress_.front().second) / elapsed : 0;
  status.set_configurations_per_second(rate);
  std::int64_t unknown = 0;
  for (const wire::SpaceStatus& space : status.spaces()) unknown += space.unknown();
  if (complete())
    status.set_eta_seconds(0);
  else if (rate > 0)
    status.set_eta_seconds(static_cast<double>(unknown) / rate);
  for (const auto& [id, worker] : workers_)
    addWorker(status, rowOf(id, worker, leases_.leasedTo(id) > 0 ? "busy" : "idle", now));
  for (const auto& [name, value] : counters_)
    (*status.mutable_counters())[name] = static_cast<std::int32_t>(value);
  return status;
}

}  // namespace palpate
