#include "tests/measure/speed_up/fleet.hpp"

#include <fmt/format.h>

#include <ctime>
#include <deque>
#include <numeric>
#include <queue>
#include <set>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "scheduler/builds/build.hpp"
#include "scheduler/service/transport.hpp"
#include "tests/support/solved_table.hpp"

namespace palpate::speed_up {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
/// As in worker/link/worker_session.cpp.
constexpr std::uint32_t jobs_in_advance = 2;
constexpr double ask_again_after = 10;
/// Workers per machine, which spot checks distinguish.
constexpr std::size_t cores = 16;

double processorNow() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Processor time of this thread by kind of work.
class Meter {
 public:
  /// Starts the measurement of this kind of work.
  void begin(Work work) {
    end();
    work_ = work;
  }
  void end() {
    const double now = processorNow();
    if (work_) spent_[static_cast<std::size_t>(*work_)] += now - since_;
    since_ = now;
    work_.reset();
  }
  std::array<double, work_names.size()>& spent() { return spent_; }
  double total() const { return std::accumulate(spent_.begin(), spent_.end(), 0.0); }

 private:
  std::optional<Work> work_;
  double since_ = 0;
  std::array<double, work_names.size()> spent_ = {};
};

Work workOf(const wire::Message& message) {
  if (message.has_result()) return Work::result;
  if (message.has_fields_request()) return Work::start;
  return message.has_heartbeat() ? Work::heartbeat : Work::request;
}

struct WorkerState {
  std::string id;
  std::deque<wire::Job> jobs;  ///< the first is being solved, once its start has arrived
  int target = 0;              ///< in the first job: the next target, or the one being solved
  bool solves = false;
  std::set<std::string, std::less<>> starts;
  double asked = 0;
};

class Fleet : private Transport {
 public:
  Fleet(const Recording& recording, const FleetSettings& settings)
      : recording_(recording),
        settings_(settings),
        build_(recording.problem(), settings.directory, timeOf(0), coordinatorSettings(settings)) {}

  FleetRun run() {
    join();
    began_ = now_;
    meter_ = {};
    measured_ = FleetRun();
    coordinator().pause(false);
    planTurn(now_);
    while (!coordinator().complete()) {
      PALPATE_ASSERT(!coordinator().stuck(), "nobody dies here, and nobody lies");
      step();
    }
    measured_.seconds = busy_until_ - began_;
    measured_.busy /= std::max(measured_.seconds, 1e-9);
    measured_.checks = measured_.results - coordinator().recorded();
    measured_.processor = meter_.spent();
    return measured_;
  }

 private:
  struct Event {
    enum class Kind : std::uint8_t { to_scheduler, to_worker, solved, beat, turn };
    double when = 0;
    std::uint64_t number = 0;  ///< in the order of planning
    Kind kind = Kind::turn;
    std::size_t worker = 0;
    std::shared_ptr<wire::Message> message = {};      ///< to a worker
    std::string bytes = {};                           ///< to the scheduler
    std::shared_ptr<const std::string> payload = {};  ///< to a worker; kept until it is read
    const std::string* result_payload = nullptr;      ///< to the scheduler
    bool operator>(const Event& other) const {
      return std::tie(when, number) > std::tie(other.when, other.number);
    }
  };

  static CoordinatorSettings coordinatorSettings(const FleetSettings& settings) {
    CoordinatorSettings all;
    if (!settings.spot_checks) all.spot_checks.share = 0;
    return all;
  }
  static Coordinator::Time timeOf(double seconds) {
    // Not the epoch, because times before the start would be negative.
    return Coordinator::Time(std::chrono::hours(1)) +
           std::chrono::duration_cast<Coordinator::Time::duration>(
               std::chrono::duration<double>(seconds));
  }
  static double secondsOf(Coordinator::Time time) {
    return std::chrono::duration<double>(time - timeOf(0)).count();
  }
  Coordinator& coordinator() { return build_.coordinator(); }

  void plan(Event event) {
    event.number = ++planned_;
    events_.push(std::move(event));
  }

  void step() {
    Event event = std::move(const_cast<Event&>(events_.top()));  // popped at once
    events_.pop();
    now_ = event.when;
    switch (event.kind) {
      case Event::Kind::to_scheduler:
        inbox_.push_back(std::move(event));
        return planTurn(std::max(now_, busy_until_));
      case Event::Kind::to_worker: return hear(event.worker, *event.message);
      case Event::Kind::solved: return deliver(event.worker);
      case Event::Kind::beat: return beat(event.worker);
      case Event::Kind::turn:
        if (event.when == next_turn_) turn();
    }
  }

  // The scheduler.

  void planTurn(double when) {
    if (when >= next_turn_) return;
    next_turn_ = when;
    plan({.when = when, .kind = Event::Kind::turn});
  }

  void turn() {
    const std::int64_t results_before = measured_.results;
    const double spent_before = meter_.total();
    exchange(coordinator(), *this, timeOf(now_));
    meter_.begin(Work::deadline);
    const double deadline = secondsOf(coordinator().nextDeadline());
    meter_.end();
    ++measured_.turns;

    const auto results = static_cast<double>(measured_.results - results_before);
    const double cost = settings_.charge_measured ? meter_.total() - spent_before
                                                  : results * settings_.cost_per_result;
    busy_until_ = now_ + cost;
    measured_.busy += cost;
    for (Event& letter : std::exchange(outbox_, {})) {
      letter.when = busy_until_ + settings_.latency;
      plan(std::move(letter));
    }
    if (measured_.until_solved == 0 &&
        std::ranges::all_of(coordinator().plans(), &SpacePlan::complete))
      measured_.until_solved = busy_until_ - began_;
    next_turn_ = never;
    // The scheduler wakes at deadlines with the accuracy of a polled socket, a millisecond.
    planTurn(inbox_.empty() ? std::max(busy_until_ + 1e-3, deadline) : busy_until_);
  }

  std::optional<Incoming> receive() override {
    if (inbox_.empty()) {
      meter_.begin(Work::advance);
      return std::nullopt;
    }
    const Event letter = std::move(inbox_.front());
    inbox_.pop_front();
    ++measured_.messages;
    meter_.begin(Work::request);
    Incoming incoming{.peer = workers_[letter.worker].id, .message = {}, .payload = {}};
    const bool parsed = incoming.message.ParseFromString(letter.bytes);
    PALPATE_ASSERT(parsed, "it was just serialized");
    if (letter.result_payload != nullptr) incoming.payload = *letter.result_payload;
    measured_.results += incoming.message.has_result();
    meter_.begin(workOf(incoming.message));
    return incoming;
  }

  Connections::Closed takeClosed() override {
    meter_.begin(Work::advance);
    return {};
  }

  Sent send(const Outgoing& outgoing) override {
    meter_.begin(Work::send);
    // Serialised as for ZeroMQ, although nobody reads it here.
    const std::string bytes = outgoing.message.SerializeAsString();
    PALPATE_ASSERT(!bytes.empty(), "a message has a body");
    outbox_.push_back({.kind = Event::Kind::to_worker,
                       .worker = number_of_.at(outgoing.peer),
                       .message = std::make_shared<wire::Message>(outgoing.message),
                       .payload = outgoing.payload});
    return Sent::yes;
  }

  // Workers.

  /// Before the clock runs: nothing is handed out, and all workers request work.
  void join() {
    coordinator().pause(true);
    workers_.resize(settings_.workers);
    for (std::size_t n = 0; n < workers_.size(); ++n) {
      workers_[n].id = fmt::format("worker-{:05}", n);
      number_of_[workers_[n].id] = n;
      wire::Message message;
      wire::Hello& hello = *message.mutable_hello();
      hello.set_protocol(protocol_version);
      hello.set_version(version());
      hello.set_worker(workers_[n].id);
      hello.set_host(fmt::format("machine-{}", n / cores));
      hello.set_pid(static_cast<std::uint32_t>(n + 1));
      hello.set_kernel_family(recording_.kernelFamily());
      say(n, message);
      // Machines do not start at the same moment.
      const double share = static_cast<double>(n) / static_cast<double>(workers_.size());
      plan({.when = 1 + share, .kind = Event::Kind::beat, .worker = n});
    }
    planTurn(0);
    while (now_ < 2) step();
  }

  void say(std::size_t n, const wire::Message& message, const std::string* payload = nullptr) {
    plan({.when = now_ + settings_.latency,
          .kind = Event::Kind::to_scheduler,
          .worker = n,
          .bytes = message.SerializeAsString(),
          .result_payload = payload});
  }

  void hear(std::size_t n, const wire::Message& message) {
    for (const wire::Message& part : message.bundle().messages()) hear(n, part);
    WorkerState& worker = workers_[n];
    if (message.has_welcome()) return requestJobs(n, jobs_in_advance);
    if (message.has_refused())
      throw failure("a worker was refused: {}", message.refused().reason());
    if (message.has_fields_reply()) {
      if (message.fields_reply().unknown())
        throw failure("a start of a job is unknown to the scheduler that named it");
      worker.starts.insert(message.fields_reply().id());
    }
    if (message.has_job()) {
      worker.jobs.push_back(message.job());
      if (!hasStart(worker, worker.jobs.back())) askForStart(n, worker.jobs.back());
    }
    beginTarget(n);
  }

  static bool hasStart(const WorkerState& worker, const wire::Job& job) {
    return job.start_id().empty() || worker.starts.contains(job.start_id());
  }

  void askForStart(std::size_t n, const wire::Job& job) {
    wire::Message message;
    wire::FieldsRequest& request = *message.mutable_fields_request();
    request.set_id(job.start_id());
    request.set_space(job.space());
    *request.mutable_point() = job.start();
    say(n, message);
    workers_[n].asked = now_;
  }

  void requestJobs(std::size_t n, std::uint32_t credit) {
    wire::Message message;
    message.mutable_request()->set_credit(credit);
    say(n, message);
  }

  const Recording::Solve& solveOf(const WorkerState& worker) const {
    const wire::Job& job = worker.jobs.front();
    return recording_.find(
        {job.space(), fromWire(job.targets(worker.target).point()), fromWire(job.start())});
  }

  void beginTarget(std::size_t n) {
    WorkerState& worker = workers_[n];
    if (worker.solves || worker.jobs.empty() || !hasStart(worker, worker.jobs.front())) return;
    worker.solves = true;
    const double seconds = solveOf(worker).seconds;
    measured_.worked += seconds;
    plan({.when = now_ + seconds, .kind = Event::Kind::solved, .worker = n});
  }

  void deliver(std::size_t n) {
    WorkerState& worker = workers_[n];
    const Recording::Solve& solve = solveOf(worker);
    const wire::Job& job = worker.jobs.front();
    wire::Message message;
    wire::Result& result = *message.mutable_result();
    result = solve.result;
    test::answer(job, job.targets(worker.target), result);
    say(n, message, &solve.payload);
    if (!result.fields_id().empty()) worker.starts.insert(result.fields_id());
    worker.solves = false;
    if (++worker.target == job.targets_size()) {
      worker.jobs.pop_front();
      worker.target = 0;
      requestJobs(n, 1);
    }
    beginTarget(n);
  }

  void beat(std::size_t n) {
    const WorkerState& worker = workers_[n];
    wire::Message message;
    wire::Heartbeat& heartbeat = *message.mutable_heartbeat();
    heartbeat.set_solving(worker.solves);
    if (worker.solves) {
      heartbeat.set_job(worker.jobs.front().id());
      *heartbeat.mutable_target() = worker.jobs.front().targets(worker.target).point();
    }
    say(n, message);
    if (!worker.solves && !worker.jobs.empty() && now_ - worker.asked > ask_again_after)
      askForStart(n, worker.jobs.front());
    plan({.when = now_ + 1, .kind = Event::Kind::beat, .worker = n});
  }

  const Recording& recording_;
  const FleetSettings settings_;
  Build build_;
  std::priority_queue<Event, std::vector<Event>, std::greater<>> events_;
  std::uint64_t planned_ = 0;
  std::deque<Event> inbox_;    ///< messages to the scheduler that have arrived and are unread
  std::vector<Event> outbox_;  ///< messages of this turn that are not sent yet
  std::vector<WorkerState> workers_;
  std::map<std::string, std::size_t> number_of_;  ///< by worker id, which is also its peer id
  double now_ = 0, began_ = 0, busy_until_ = 0, next_turn_ = never;
  Meter meter_;
  FleetRun measured_;
};

}  // namespace

double FleetRun::processorSeconds() const {
  return std::accumulate(processor.begin(), processor.end(), 0.0);
}

FleetRun runFleet(const Recording& recording, const FleetSettings& settings) {
  return Fleet(recording, settings).run();
}

}  // namespace palpate::speed_up
