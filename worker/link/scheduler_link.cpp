#include "worker/link/scheduler_link.hpp"

#include <sodium.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

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

std::string randomId() {
  std::string id(16, '\0');
  randombytes_buf(id.data(), id.size());
  return id;
}

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

std::size_t bytesOfFields(const NodalFields& fields) {
  return sizeof(float) * (fields.displacement.size() + fields.pressure.size());
}

}  // namespace

SchedulerLink::SchedulerLink(zmq::context_t& context, Mailbox& mailbox,
                             const ElementKernels& kernels, LinkOptions options)
    : context_(context),
      mailbox_(mailbox),
      kernels_(kernels),
      options_(std::move(options)),
      worker_id_(randomId()) {
  checkEndpoint(options_.endpoint);
}

void SchedulerLink::connect() {
  socket_ = makeDealer(context_);
  // A leading zero byte is reserved by ZeroMQ, so the routing id is not the bare random id.
  socket_.set(zmq::sockopt::routing_id, "w" + worker_id_);
  try {
    socket_.connect(options_.endpoint);
  } catch (const zmq::error_t& error) {
    throw badInput("cannot connect to {}: {}", options_.endpoint, error.what());
  }
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
  hello.set_worker(worker_id_);
  hello.set_host(hostName());
  hello.set_pid(static_cast<std::uint32_t>(getpid()));
  hello.set_kernel_family(arithmetic(kernels_));
  send(message);
  last_sent_hello_ = Clock::now();
}

void SchedulerLink::requestJobs(std::uint32_t credit) {
  if (draining_ || credit == 0) return;
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
  if (message.body_case() == wire::Message::BODY_NOT_SET) return;
  last_heard_ = Clock::now();
  switch (message.body_case()) {
    case wire::Message::kWelcome:
      return handleWelcome(message.welcome());
    case wire::Message::kRefused:
      throw failure("the scheduler at {} refused this worker: {}", options_.endpoint,
                    message.refused().reason());
    case wire::Message::kProblemReply:
      return handleProblem(message.problem_reply(), incoming.payload);
    case wire::Message::kJob:
      return handleJob(message.job());
    case wire::Message::kFieldsReply:
      return handleFields(message.fields_reply(), incoming.payload);
    case wire::Message::kResultAck: {
      const wire::ResultAck& ack = message.result_ack();
      unacknowledged_.erase({ack.space(), fromWire(ack.target()), fromWire(ack.parent())});
      return;
    }
    case wire::Message::kHeartbeatReply:
      // Another incarnation knows nothing of us, of our jobs, nor of results it did not
      // acknowledge.
      if (!incarnation_.empty() && message.heartbeat_reply().incarnation() != incarnation_) {
        spdlog::info("the scheduler was restarted; introducing this worker again");
        introduceAgain();
      }
      return;
    case wire::Message::kDrain:
      draining_ = true;
      finished_ = message.drain().finished();
      forgetWork();
      return;
    default:
      spdlog::warn("the scheduler sent a message that is not for workers");
  }
}

void SchedulerLink::handleWelcome(const wire::Welcome& welcome) {
  if (incarnation_ == welcome.incarnation()) return;
  const auto build = ContentId::fromBytes(welcome.build());
  if (!build) throw failure("the scheduler at {} sent a damaged welcome", options_.endpoint);
  incarnation_ = welcome.incarnation();
  heartbeat_ =
      std::chrono::milliseconds(std::clamp<std::uint32_t>(welcome.heartbeat_ms(), 50, 60000));
  forgetWork();
  if (*build != build_ || !problem_) {
    build_ = *build;
    problem_.reset();
    unacknowledged_.clear();
    cache_.clear();
    cache_bytes_ = 0;
    wire::Message message;
    message.mutable_problem_request();
    send(message);
    return;
  }
  deliverAgain();
  requestJobs(options_.credit);
}

void SchedulerLink::deliverAgain() {
  for (const auto& [key, finished] : unacknowledged_) {
    wire::Message message;
    *message.mutable_result() = finished.result;
    send(message, finished.fields);
  }
  last_delivered_ = Clock::now();
}

void SchedulerLink::introduceAgain() {
  incarnation_.clear();
  forgetWork();
  sayHello();
}

void SchedulerLink::handleProblem(const wire::ProblemReply& reply, const std::string& payload) {
  if (problem_ || reply.build() != build_.bytes()) return;
  auto problem = std::make_shared<Problem>(decodeProblem(payload));
  if (problemId(*problem) != build_)
    throw failure("the problem that the scheduler at {} sent is not build {}", options_.endpoint,
                  build_.shortHex());
  problem_ = std::move(problem);
  spdlog::info("working on \"{}\", {} nodes, {} kernels", problem_->scene.name,
               problem_->mesh.nodes.size(), kernels_.family);
  requestJobs(options_.credit);
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
  remember(*id, std::make_shared<NodalFields>(NodalFields::decode(
                    payload, problem_->mesh.nodes.size(), pressureNodes(*problem_))));
  startReadyJobs();
}

void SchedulerLink::startReadyJobs() {
  while (!waiting_.empty()) {
    std::shared_ptr<const NodalFields> start;
    if (const auto id = ContentId::fromBytes(waiting_.front().start_id())) {
      start = cached(*id);
      if (!start) return;
    }
    mailbox_.put({problem_, std::move(waiting_.front()), std::move(start)});
    waiting_.pop_front();
  }
}

std::shared_ptr<const NodalFields> SchedulerLink::cached(const ContentId& id) {
  const auto found = std::find_if(cache_.begin(), cache_.end(),
                                  [&](const auto& entry) { return entry.first == id; });
  if (found == cache_.end()) return nullptr;
  cache_.splice(cache_.begin(), cache_, found);
  return found->second;
}

void SchedulerLink::remember(const ContentId& id, std::shared_ptr<const NodalFields> fields) {
  if (cached(id)) return;
  cache_bytes_ += bytesOfFields(*fields);
  cache_.emplace_front(id, std::move(fields));
  while (cache_bytes_ > cache_limit_bytes && cache_.size() > 1) {
    cache_bytes_ -= bytesOfFields(*cache_.back().second);
    cache_.pop_back();
  }
}

void SchedulerLink::deliverFinished() {
  for (FinishedTarget& finished : mailbox_.takeFinished()) {
    if (const auto id = ContentId::fromBytes(finished.result.fields_id()); id && problem_)
      remember(*id, std::make_shared<NodalFields>(NodalFields::decode(
                        finished.fields, problem_->mesh.nodes.size(), pressureNodes(*problem_))));
    const wire::Result& result = finished.result;
    if (result.build() != build_.bytes()) continue;  // of a build that this scheduler left behind
    wire::Message message;
    *message.mutable_result() = result;
    send(message, finished.fields);
    last_delivered_ = Clock::now();
    if (finished.last_of_job) requestJobs(1);
    const ResultKey key{result.space(), fromWire(result.target()), fromWire(result.parent())};
    unacknowledged_.insert_or_assign(key, std::move(finished));
  }
}

void SchedulerLink::beat() {
  const Progress progress = mailbox_.progress();
  wire::Message message;
  wire::Heartbeat& heartbeat = *message.mutable_heartbeat();
  heartbeat.set_solving(progress.solving);
  heartbeat.set_job(progress.job);
  *heartbeat.mutable_target() = progress.target;
  send(message);
  last_beat_ = Clock::now();
  if (!unacknowledged_.empty() && last_beat_ - last_delivered_ > deliver_again_after)
    deliverAgain();
}

LinkEnd SchedulerLink::run() {
  connect();
  last_heard_ = Clock::now();
  std::optional<Clock::time_point> interrupted_at;
  for (;;) {
    std::array<zmq::pollitem_t, 2> items = {
        {{socket_.handle(), 0, ZMQ_POLLIN, 0},
         {nullptr, mailbox_.wakeUpDescriptor(), ZMQ_POLLIN, 0}}};
    try {
      zmq::poll(items.data(), items.size(), poll_interval);
    } catch (const zmq::error_t& error) {
      if (error.num() != EINTR) throw failure("ZeroMQ poll: {}", error.what());
    }
    while (const auto incoming = receiveMessage(socket_, false)) handle(*incoming);
    deliverFinished();
    if (const auto error = mailbox_.solverError()) throw failure("the solver stopped: {}", *error);

    const auto now = Clock::now();
    if (interrupted() && !interrupted_at) {
      interrupted_at = now;
      draining_ = true;
      forgetWork();
    }
    if (draining_ && unacknowledged_.empty() && !mailbox_.progress().solving) {
      if (finished_) return LinkEnd::finished;
      wire::Message message;
      message.mutable_goodbye()->set_reason(interrupted_at ? "interrupted" : "drained");
      send(message);
      // LINGER is 0; give the goodbye a moment to leave.
      socket_.set(zmq::sockopt::linger, 500);
      return interrupted_at ? LinkEnd::interrupted : LinkEnd::finished;
    }
    if (interrupted_at && now - *interrupted_at > options_.drain) return LinkEnd::interrupted;
    if (now - last_heard_ > options_.give_up) return LinkEnd::given_up;
    if (now - std::max(last_heard_, last_connected_) > options_.reconnect_after) {
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
