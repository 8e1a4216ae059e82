#include "worker/link/scheduler_link.hpp"

#include <sodium.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "common/base/assertion.hpp"
#include "common/base/program.hpp"

namespace palpate {
namespace {

/// Start configurations kept: many hundred of a coarse mesh, dozens of a fine one.
constexpr std::size_t cache_limit_bytes = 64u << 20;
constexpr std::chrono::milliseconds hello_interval{1000};
constexpr std::chrono::milliseconds poll_interval{50};
/// An acknowledgement takes milliseconds; this long without one, the result or the acknowledgement
/// was lost on the way.
constexpr std::chrono::milliseconds deliver_again_after{10000};
/// Without any word from the scheduler for this long, the socket is made anew.
constexpr std::chrono::milliseconds reconnect_after{20000};
/// Jobs asked for in advance: the one in work and one that hides the network.
constexpr std::uint32_t jobs_in_advance = 2;
/// A worker that does nothing for so long was stopped, or had no processor time: neither the
/// scheduler's silence nor its solver's counts.
constexpr std::chrono::milliseconds own_gap{3000};

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

using Seconds = std::chrono::duration<double>;

/// (space, target, parent): the key of a result.
template <class ResultOrAck>
auto keyOf(const ResultOrAck& message) {
  return std::tuple(message.space(), fromWire(message.target()), fromWire(message.parent()));
}

/// Without a goodbye: the scheduler is to know what this process ended on. Nothing less ends a
/// thread that never returns.
[[noreturn]] void endHungProcess(std::chrono::seconds at_it) {
  spdlog::error(
      "the solver hangs: {} s at one target, many times the longest of this build; this worker "
      "ends itself, and its targets go to others",
      at_it.count());
  raise(SIGKILL);
  std::abort();
}

}  // namespace

std::string randomWorkerId() {
  std::string id(16, '\0');
  if (sodium_init() < 0) throw failure("libsodium could not be initialised");
  randombytes_buf(id.data(), id.size());
  return id;
}

SchedulerLink::SchedulerLink(zmq::context_t& context, Mailbox& mailbox,
                             const ElementKernels& kernels, LinkOptions options)
    : context_(context), mailbox_(mailbox), kernels_(kernels), options_(std::move(options)) {}

void SchedulerLink::connect() {
  socket_ = makeDealer(context_);
  // A leading zero byte is reserved by ZeroMQ, so the routing id is not the bare random id.
  socket_.set(zmq::sockopt::routing_id, "w" + options_.worker_id);
  connectDealer(socket_, options_.endpoint);
  last_connected_ = Clock::now();
  last_sent_hello_ = {};
  incarnation_.clear();
}

void SchedulerLink::send(const wire::Message& message, std::string_view payload) {
  // Nothing is lost when this fails: hellos, requests and results are all sent again.
  if (sendMessage(socket_, "", message, payload) != Sent::yes)
    spdlog::debug("the scheduler does not take messages now");
}

void SchedulerLink::sayHello() {
  wire::Message message;
  wire::Hello& hello = *message.mutable_hello();
  hello.set_protocol(protocol_version);
  hello.set_version(version());
  hello.set_worker(options_.worker_id);
  for (const std::string& ended : options_.ended) hello.add_ended(ended);
  hello.set_host(hostName());
  hello.set_pid(static_cast<std::uint32_t>(getpid()));
  hello.set_kernel_family(arithmetic(kernels_));
  send(message);
  last_sent_hello_ = Clock::now();
}

void SchedulerLink::requestJobs(std::uint32_t credit) {
  if (draining_) return;
  wire::Message message;
  message.mutable_request()->set_credit(credit);
  send(message);
}

void SchedulerLink::forgetWork() {
  waiting_.clear();
  mailbox_.forgetJobs();
}

void SchedulerLink::handle(const Incoming& incoming) {
  const wire::Message& message = incoming.message;
  // What cannot be read is no sign that a scheduler lives: the silence goes on.
  if (message.body_case() == wire::Message::BODY_NOT_SET) return;
  last_heard_ = Clock::now();
  if (message.has_refused())
    throw failure("the scheduler at {} refused this worker: {}", options_.endpoint,
                  message.refused().reason());
  if (message.has_welcome()) return handleWelcome(message.welcome());
  if (message.has_problem_reply()) return handleProblem(message.problem_reply(), incoming.payload);
  if (message.has_job()) return handleJob(message.job());
  if (message.has_fields_reply()) return handleFields(message.fields_reply(), incoming.payload);
  if (message.has_result_ack()) return void(unacknowledged_.erase(keyOf(message.result_ack())));
  if (message.has_heartbeat_reply()) return handleHeartbeat(message.heartbeat_reply());
  if (message.has_drain()) {
    finished_ = message.drain().finished();
    return drain();
  }
  spdlog::warn("the scheduler sent a message that is not for workers");
}

void SchedulerLink::handleHeartbeat(const wire::HeartbeatReply& reply) {
  // Another incarnation knows nothing of us, of our jobs, nor of results it did not acknowledge.
  if (incarnation_.empty() || reply.incarnation() == incarnation_) return;
  spdlog::info("the scheduler was restarted; introducing this worker again");
  introduceAgain();
}

void SchedulerLink::drain() {
  draining_ = true;
  forgetWork();
}

void SchedulerLink::handleWelcome(const wire::Welcome& welcome) {
  // The answer to a hello that was said twice.
  if (incarnation_ == welcome.incarnation()) return;
  const auto build = ContentId::fromBytes(welcome.build());
  if (!build) throw failure("the scheduler at {} sent a damaged welcome", options_.endpoint);
  incarnation_ = welcome.incarnation();
  heartbeat_ =
      std::chrono::milliseconds(std::clamp<std::uint32_t>(welcome.heartbeat_ms(), 50, 60000));
  forgetWork();
  // Of another build nothing is worth keeping, and jobs are asked for when its problem is here.
  if (*build != build_ || !problem_) {
    build_ = *build;
    problem_.reset();
    unacknowledged_.clear();
    cache_.clear();
    wire::Message message;
    message.mutable_problem_request();
    send(message);
    return;
  }
  deliverAgain();
  requestJobs(jobs_in_advance);
}

void SchedulerLink::deliverAgain() {
  for (const auto& [key, finished] : unacknowledged_) deliver(finished);
}

void SchedulerLink::deliver(const FinishedTarget& finished) {
  wire::Message message;
  *message.mutable_result() = finished.result;
  send(message, finished.fields);
  last_delivered_ = Clock::now();
}

/// The scheduler takes back what a worker holds that says hello again, and hands it out anew.
void SchedulerLink::introduceAgain() {
  incarnation_.clear();
  forgetWork();
  sayHello();
}

void SchedulerLink::handleProblem(const wire::ProblemReply& reply, const std::string& payload) {
  // Asked for twice, or by an earlier welcome.
  if (problem_ || reply.build() != build_.bytes()) return;
  auto problem = std::make_shared<Problem>(decodeProblem(payload));
  // The bits of every result rest on it, so that it is compared whole.
  if (problemId(*problem) != build_)
    throw failure("the problem that the scheduler at {} sent is not build {}", options_.endpoint,
                  build_.shortHex());
  problem_ = std::move(problem);
  spdlog::info("working on \"{}\", {} nodes, {} kernels", problem_->scene.name,
               problem_->mesh.nodes.size(), kernels_.family);
  requestJobs(jobs_in_advance);
}

void SchedulerLink::handleJob(const wire::Job& job) {
  if (!problem_ || draining_) return;
  const bool sensible = job.space() < problem_->active.size() && job.targets_size() > 0 &&
                        (job.start_id().empty() || job.start_id().size() == 32);
  if (!sensible) {
    spdlog::warn("the scheduler sent job {} that makes no sense here; ignored", job.id());
    return;
  }
  waiting_.push_back(job);
  const auto id = ContentId::fromBytes(job.start_id());
  if (id && !cached(*id)) {
    wire::Message message;
    wire::FieldsRequest& request = *message.mutable_fields_request();
    request.set_id(job.start_id());
    request.set_space(job.space());
    *request.mutable_point() = job.start();
    send(message);
  }
  startReadyJobs();
}

void SchedulerLink::handleFields(const wire::FieldsReply& reply, const std::string& payload) {
  const auto id = ContentId::fromBytes(reply.id());
  if (!id || !problem_) return;
  if (reply.unknown() || ContentId::of(payload) != *id) {
    spdlog::warn("the scheduler could not send start configuration {}; its jobs are handed back",
                 id->shortHex());
    introduceAgain();
    return;
  }
  remember(*id, payload);
  startReadyJobs();
}

void SchedulerLink::startReadyJobs() {
  while (!waiting_.empty()) {
    std::shared_ptr<const NodalFields> start;
    // In their order, even if a later one has its start here: the scheduler counts on it when it
    // guesses which target killed a worker.
    if (const auto id = ContentId::fromBytes(waiting_.front().start_id())) {
      start = cached(*id);
      if (!start) return;
    }
    mailbox_.put({problem_, std::move(waiting_.front()), std::move(start)});
    waiting_.pop_front();
  }
}

std::shared_ptr<const NodalFields> SchedulerLink::cached(const ContentId& id) {
  const auto found = std::ranges::find(cache_, id, [](const auto& entry) { return entry.first; });
  if (found == cache_.end()) return nullptr;
  cache_.splice(cache_.begin(), cache_, found);
  return found->second;
}

void SchedulerLink::remember(const ContentId& id, const std::string& payload) {
  if (cached(id)) return;
  PALPATE_ASSERT(problem_, "start configurations are those of a problem");
  const std::size_t n_nodes = problem_->mesh.nodes.size(), n_pressures = pressureNodes(*problem_);
  cache_.emplace_front(
      id, std::make_shared<const NodalFields>(NodalFields::decode(payload, n_nodes, n_pressures)));
  // All fields of a problem are equally long. The newest stays, however long it is.
  const std::size_t most = std::max<std::size_t>(1, cache_limit_bytes / payload.size());
  if (cache_.size() > most) cache_.pop_back();
}

void SchedulerLink::deliverFinished() {
  for (FinishedTarget& finished : mailbox_.takeFinished()) {
    const wire::Result& result = finished.result;
    if (result.build() != build_.bytes()) continue;  // of a build that this scheduler left behind
    // The next job is likely to start where this one ended. Without the problem it is fetched.
    if (const auto id = ContentId::fromBytes(result.fields_id()); id && problem_)
      remember(*id, finished.fields);
    deliver(finished);
    if (finished.last_of_job) requestJobs(1);
    unacknowledged_.insert_or_assign(keyOf(result), std::move(finished));
  }
}

void SchedulerLink::beat() {
  wire::Message message;
  *message.mutable_heartbeat() = mailbox_.progress();
  send(message);
  last_beat_ = Clock::now();
  if (!unacknowledged_.empty() && last_beat_ - last_delivered_ > deliver_again_after)
    deliverAgain();
}

void SchedulerLink::sayGoodbye(const char* reason) {
  wire::Message message;
  message.mutable_goodbye()->set_reason(reason);
  send(message);
  // LINGER is 0; give the goodbye a moment to leave.
  socket_.set(zmq::sockopt::linger, 500);
}

void SchedulerLink::forgiveOwnGap() {
  const auto now = Clock::now();
  const auto gap = now - std::exchange(last_turn_, now);
  if (gap < own_gap) return;
  last_heard_ += gap;
  mailbox_.forgive(gap);
}

ExitCode SchedulerLink::run() {
  connect();
  last_heard_ = last_turn_ = Clock::now();
  std::optional<Clock::time_point> interrupted_at;
  for (;;) {
    waitForMessages(socket_, poll_interval, mailbox_.wakeUpDescriptor());
    forgiveOwnGap();
    while (const auto incoming = receiveMessage(socket_, false)) handle(*incoming);
    deliverFinished();
    if (const auto error = mailbox_.solverError()) throw failure("the solver stopped: {}", *error);
    if (const auto hung = mailbox_.hungFor()) endHungProcess(*hung);

    const auto now = Clock::now();
    if (interrupted() && !interrupted_at) {
      interrupted_at = now;
      drain();
    }
    if (draining_ && unacknowledged_.empty() && !mailbox_.progress().solving()) {
      sayGoodbye(interrupted_at ? "interrupted" : finished_ ? "no more work" : "drained");
      return interrupted_at && !finished_ ? ExitCode::interrupted : ExitCode::done;
    }
    if (interrupted_at && now - *interrupted_at > Seconds(options_.drain_s)) {
      sayGoodbye("interrupted in a solve");
      return ExitCode::interrupted;
    }
    if (now - last_heard_ > Seconds(options_.give_up_s))
      throw failure("no word from {} for {} s: is the scheduler running, and is this its address?",
                    options_.endpoint, options_.give_up_s);
    if (now - std::max(last_heard_, last_connected_) > reconnect_after) {
      spdlog::warn("no word from {} for {} s; connecting anew", options_.endpoint,
                   std::chrono::duration_cast<std::chrono::seconds>(now - last_heard_).count());
      connect();
    }
    if (incarnation_.empty()) {
      if (now - last_sent_hello_ > hello_interval) sayHello();
    } else if (now - last_beat_ > heartbeat_) {
      beat();
    }
  }
}

}  // namespace palpate
