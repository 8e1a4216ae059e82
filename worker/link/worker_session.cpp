#include "worker/link/worker_session.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/number_text.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

/// Size limit of the cache of start configurations. It holds many hundreds for a coarse mesh,
/// dozens for a fine one.
constexpr std::size_t cache_limit_bytes = 64u << 20;
constexpr std::chrono::milliseconds hello_interval{1000};
/// A message without an answer is repeated after this time. Answers and acknowledgements take
/// milliseconds, so the message or its answer was lost, for instance with a broken connection.
constexpr std::chrono::milliseconds say_again_after{10000};
/// After this long without a message from the scheduler, a new socket is made.
constexpr std::chrono::milliseconds reconnect_after{20000};
/// Number of jobs that are requested in advance: one to solve, and one to hide the latency of the
/// network.
constexpr std::uint32_t jobs_in_advance = 2;
/// If this thread does not run for this long, the process was suspended or had no processor time.
/// This time is added neither to the silence of the scheduler nor to the time of the solver.
constexpr std::chrono::milliseconds own_gap{3000};

using Seconds = std::chrono::duration<double>;

}  // namespace

WorkerSession::WorkerSession(Mailbox& mailbox, SessionOptions options, Time now)
    : mailbox_(mailbox),
      options_(std::move(options)),
      last_turn_(now),
      last_heard_(now),
      last_connected_(now),
      last_sent_hello_(now - hello_interval),
      begun_at_(now) {}

wire::Message& WorkerSession::send(std::string payload) {
  return outbox_.emplace_back(Letter{{}, std::move(payload)}).message;
}

std::vector<Letter> WorkerSession::takeOutbox() {
  Bundler bundler;
  for (Letter& letter : std::exchange(outbox_, {}))
    bundler.add(std::move(letter.message), letter.payload);
  return bundler.take();
}

void WorkerSession::connected(Time now) {
  last_connected_ = now;
  last_sent_hello_ = now - hello_interval;
  epoch_.clear();
}

void WorkerSession::sayHello(Time now) {
  wire::Hello& hello = *send().mutable_hello();
  hello.set_protocol(protocol_version);
  hello.set_version(buildName());
  hello.set_worker(options_.worker_id);
  for (const std::string& ended : options_.ended) hello.add_ended(ended);
  hello.set_host(options_.host);
  hello.set_pid(options_.pid);
  hello.set_kernel_family(options_.kernel_family);
  for (const std::string& family : options_.runs) hello.add_runs(family);
  last_sent_hello_ = now;
}

void WorkerSession::requestJobs(std::uint32_t credit, bool afresh, Time now) {
  if (draining_) return;
  wire::Request& request = *send().mutable_request();
  request.set_credit(credit);
  request.set_afresh(afresh);
  last_asked_ = now;
}

void WorkerSession::forgetWork() {
  waiting_.clear();
  mailbox_.forgetJobs();
}

void WorkerSession::receive(const Incoming& incoming, Time now) {
  forgiveOwnGap(now);
  const wire::Message& message = incoming.message;
  // An unreadable message does not prove that a scheduler is alive.
  if (message.body_case() == wire::Message::BODY_NOT_SET) return;
  last_heard_ = now;
  if (message.has_refused())
    throw failure("the scheduler at {} refused this worker: {}", options_.endpoint,
                  printable(message.refused().reason(), longest_reason));
  if (message.has_welcome()) return handleWelcome(message.welcome(), now);
  if (message.has_use_kernels()) return handleUseKernels(message.use_kernels().kernel_family());
  if (message.has_problem_reply())
    return handleProblem(message.problem_reply(), incoming.payload, now);
  if (message.has_job()) return handleJob(message.job(), now);
  if (message.has_fields_reply())
    return handleFields(message.fields_reply(), incoming.payload, now);
  if (message.has_result_ack()) return void(unacknowledged_.erase(keyOf(message.result_ack())));
  if (message.has_heartbeat_reply()) return handleHeartbeat(message.heartbeat_reply(), now);
  if (message.has_drain()) {
    finished_ = message.drain().finished();
    return drain();
  }
  spdlog::warn("the scheduler sent a message that is not for workers");
}

void WorkerSession::handleHeartbeat(const wire::HeartbeatReply& reply, Time now) {
  // A restarted scheduler has a new epoch. It knows neither this worker nor its jobs, nor the
  // results that were not acknowledged.
  if (epoch_.empty() || reply.epoch() == epoch_) return;
  spdlog::info("the scheduler was restarted; introducing this worker again");
  introduceAgain(now);
}

void WorkerSession::drain() {
  draining_ = true;
  forgetWork();
}

void WorkerSession::handleWelcome(const wire::Welcome& welcome, Time now) {
  // This Welcome is the second answer to a Hello that was repeated.
  if (epoch_ == welcome.epoch()) return;
  const auto build = ContentId::fromBytes(welcome.build());
  if (!build) throw failure("the scheduler at {} sent an invalid build id", options_.endpoint);
  epoch_ = welcome.epoch();
  heartbeat_ =
      std::chrono::milliseconds(std::clamp<std::uint32_t>(welcome.heartbeat_ms(), 50, 60000));
  forgetWork();
  // A scheduler that told this worker to leave is gone now. So the worker stays, unless it was
  // interrupted.
  draining_ = interrupted_at_.has_value();
  // If the build has changed, results and start configurations of the old one are useless. Jobs are
  // requested once the new problem has arrived.
  if (*build != build_ || !problem_) {
    build_ = *build;
    problem_.reset();
    unacknowledged_.clear();
    cache_.clear();
    return askForProblem(now);
  }
  deliverAgain(now);
  requestJobs(jobs_in_advance, true, now);
}

void WorkerSession::handleUseKernels(const std::string& family) {
  if (std::ranges::find(options_.runs, family) == options_.runs.end())
    throw failure("the scheduler at {} wants the {} kernels, which this worker does not offer",
                  options_.endpoint, printable(family, longest_reason));
  wanted_kernels_ = family;
}

void WorkerSession::deliverAgain(Time now) {
  for (const auto& [key, finished] : unacknowledged_) deliver(finished, now);
}

void WorkerSession::deliver(const FinishedTarget& finished, Time now) {
  *send(finished.fields).mutable_result() = finished.result;
  last_delivered_ = now;
}

/// Drops all work and says hello. The hello makes the scheduler take back this worker's jobs and
/// hand them out again.
void WorkerSession::introduceAgain(Time now) {
  epoch_.clear();
  forgetWork();
  sayHello(now);
}

void WorkerSession::handleProblem(const wire::ProblemReply& reply, const std::string& payload,
                                  Time now) {
  // This reply answers a repeated request, or one for the problem of an earlier build.
  if (problem_ || reply.build() != build_.bytes()) return;
  auto problem = std::make_shared<Problem>(decodeProblem(payload));
  // The id covers the whole problem, because the bits of every result depend on all of it.
  if (problemId(*problem) != build_)
    throw failure("the problem that the scheduler at {} sent is not build {}", options_.endpoint,
                  build_.shortHex());
  problem_ = std::move(problem);
  spdlog::info("working on \"{}\", {}, {} kernels", problem_->scene.name,
               counted(problem_->mesh.nodes.size(), "node"), options_.kernel_family);
  requestJobs(jobs_in_advance, true, now);
}

void WorkerSession::askForProblem(Time now) {
  send().mutable_problem_request();
  last_asked_ = now;
}

void WorkerSession::askForStart(const wire::Job& job, Time now) {
  wire::FieldsRequest& request = *send().mutable_fields_request();
  request.set_id(job.start_id());
  request.set_space(job.space());
  *request.mutable_point() = job.start();
  last_asked_ = now;
}

void WorkerSession::handleJob(const wire::Job& job, Time now) {
  if (!problem_ || draining_) return;
  const bool sensible = job.space() < problem_->active.size() && job.targets_size() > 0 &&
                        (job.start_id().empty() || job.start_id().size() == 32);
  if (!sensible) {
    spdlog::warn("ignored job {} of the scheduler, which is invalid for this build", job.id());
    return;
  }
  waiting_.push_back(job);
  if (const auto id = ContentId::fromBytes(job.start_id()); id && !cached(*id))
    askForStart(job, now);
  startReadyJobs();
}

void WorkerSession::handleFields(const wire::FieldsReply& reply, const std::string& payload,
                                 Time now) {
  const auto id = ContentId::fromBytes(reply.id());
  if (!id || !problem_) return;
  if (reply.unknown() || ContentId::of(payload) != *id) {
    spdlog::warn("the scheduler could not send start configuration {}; its jobs are returned",
                 id->shortHex());
    introduceAgain(now);
    return;
  }
  remember(*id, payload);
  startReadyJobs();
}

void WorkerSession::startReadyJobs() {
  while (!waiting_.empty()) {
    std::shared_ptr<const NodalFields> start;
    // Jobs are solved in order, even if a later job already has its start. The scheduler relies on
    // this order when it guesses which target killed a worker.
    if (const auto id = ContentId::fromBytes(waiting_.front().start_id())) {
      start = cached(*id);
      if (!start) return;
    }
    mailbox_.put({problem_, std::move(waiting_.front()), std::move(start)});
    waiting_.pop_front();
  }
}

std::shared_ptr<const NodalFields> WorkerSession::cached(const ContentId& id) {
  const auto found = std::ranges::find(cache_, id, [](const auto& entry) { return entry.first; });
  if (found == cache_.end()) return nullptr;
  cache_.splice(cache_.begin(), cache_, found);
  return found->second;
}

void WorkerSession::remember(const ContentId& id, const std::string& payload) {
  if (cached(id)) return;
  PALPATE_ASSERT(problem_, "the problem must arrive before start configurations");
  const std::size_t n_nodes = problem_->mesh.nodes.size(),
                    n_pressures = problem_->pressures.count();
  cache_.emplace_front(
      id, std::make_shared<const NodalFields>(NodalFields::decode(payload, n_nodes, n_pressures)));
  // The fields of all configurations of a problem have the same size. The newest entry stays,
  // whatever its size.
  const std::size_t most = std::max<std::size_t>(1, cache_limit_bytes / payload.size());
  if (cache_.size() > most) cache_.pop_back();
}

void WorkerSession::deliverFinished(Time now) {
  for (FinishedTarget& finished : mailbox_.takeFinished()) {
    const wire::Result& result = finished.result;
    if (result.build() != build_.bytes()) continue;  // the result belongs to an earlier build
    // The next job is likely to start from this result, so it is cached. Without a problem it
    // cannot be decoded, and is requested when it is needed.
    if (const auto id = ContentId::fromBytes(result.fields_id()); id && problem_)
      remember(*id, finished.fields);
    deliver(finished, now);
    if (finished.last_of_job) requestJobs(1, false, now);
    unacknowledged_.insert_or_assign(keyOf(result), std::move(finished));
  }
}

void WorkerSession::beat(Time now) {
  const wire::Heartbeat heartbeat = mailbox_.progress().heartbeat;
  *send().mutable_heartbeat() = heartbeat;
  last_beat_ = now;
  if (now - last_asked_ > say_again_after) askAgain(heartbeat.solving(), now);
  if (!unacknowledged_.empty() && now - last_delivered_ > say_again_after) deliverAgain(now);
}

void WorkerSession::askAgain(bool solving, Time now) {
  if (!problem_)
    askForProblem(now);
  else if (!waiting_.empty())
    askForStart(waiting_.front(), now);
  else if (!solving)
    requestJobs(jobs_in_advance, true, now);
}

WorkerSession::Next WorkerSession::sayGoodbye(const char* reason) {
  send().mutable_goodbye()->set_reason(reason);
  return Next::end;
}

void WorkerSession::forgiveOwnGap(Time now) {
  const auto gap = now - std::exchange(last_turn_, now);
  if (gap < own_gap) return;
  last_heard_ += gap;
  begun_at_ += gap;
  if (idle_since_) *idle_since_ += gap;
}

/// Returns whether the worker has been idle for leave_idle_s: no job was queued or being solved,
/// and every result was acknowledged.
bool WorkerSession::isIdleForLong(Time now) {
  if (!waiting_.empty() || !unacknowledged_.empty() || mailbox_.hasWork())
    idle_since_.reset();
  else if (!idle_since_)
    idle_since_ = now;
  return options_.leave_idle_s > 0 && idle_since_ &&
         now - *idle_since_ > Seconds(options_.leave_idle_s);
}

bool WorkerSession::solverHangs(Time now) {
  const Mailbox::Progress progress = mailbox_.progress();
  if (std::exchange(begun_, progress.begun) != progress.begun) begun_at_ = now;
  const auto limit = progress.hung_after;
  if (!progress.heartbeat.solving() || limit.count() == 0 || now - begun_at_ <= limit) return false;
  spdlog::error(
      "the solver hangs: {} s on one solve, above the limit of {} s; this worker ends, and other "
      "workers get its solves",
      std::chrono::duration_cast<std::chrono::seconds>(now - begun_at_).count(), limit.count());
  return true;
}

void WorkerSession::interrupt(Time now) {
  if (interrupted_at_) return;
  interrupted_at_ = now;
  drain();
}

ExitCode WorkerSession::exitCode() const {
  return interrupted_at_ && !finished_ ? ExitCode::interrupted : ExitCode::done;
}

WorkerSession::Next WorkerSession::advance(Time now) {
  forgiveOwnGap(now);
  if (!wanted_kernels_.empty()) return Next::anew;
  deliverFinished(now);
  if (const auto error = mailbox_.solverError()) throw failure("the solver stopped: {}", *error);
  // No goodbye is sent, so that the scheduler learns which target ended this process.
  if (solverHangs(now)) return Next::killed;
  if (draining_ && unacknowledged_.empty() && !mailbox_.progress().heartbeat.solving())
    return sayGoodbye(interrupted_at_ ? "interrupted" : finished_ ? "no more work" : "drained");
  if (interrupted_at_ && now - *interrupted_at_ > Seconds(options_.drain_s))
    return sayGoodbye("interrupted in a solve");
  if (isIdleForLong(now)) return sayGoodbye("nothing to do");
  if (now - last_heard_ > Seconds(options_.give_up_s))
    throw failure("no message from {} for {} s; is the scheduler running, and is this its address?",
                  options_.endpoint, options_.give_up_s);
  if (now - std::max(last_heard_, last_connected_) > reconnect_after) {
    spdlog::warn("no message from {} for {} s; connecting again", options_.endpoint,
                 std::chrono::duration_cast<std::chrono::seconds>(now - last_heard_).count());
    return Next::connect;
  }
  if (epoch_.empty()) {
    if (now - last_sent_hello_ >= hello_interval) sayHello(now);
  } else if (now - last_beat_ > heartbeat_) {
    beat(now);
  }
  return Next::go_on;
}

}  // namespace palpate
