#include "scheduler/service/people.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/text.hpp"

namespace palpate {
namespace {

constexpr std::chrono::seconds servers_written_every{5};
/// Time from the last write of the table of servers until the next one if workers have joined, for
/// every workers_per_wait workers. The time is short, because users look for the worker that they
/// just started. It grows with the number of workers: otherwise, in a flood of new workers, each
/// would cause all rows to be written.
constexpr std::chrono::milliseconds newcomers_written_after{1};  // per workers_per_wait workers
constexpr std::size_t workers_per_wait = 8;

}  // namespace

People::People(ServiceState& state, Workers& workers, const SecondSolves& seconds,
               const Intake& intake)
    : state_(state),
      workers_(workers),
      seconds_(seconds),
      intake_(intake),
      servers_written_(state.now),
      pace_(state.now),
      work_pace_(state.now),
      measured_(state.now) {
  for (const auto& [name, priority] : state_.tables.priorities()) prioritize(name, priority);
}

bool People::answer(const Incoming& incoming) {
  const wire::Message& message = incoming.message;
  const std::string& peer = incoming.peer;
  switch (message.body_case()) {
    case wire::Message::kStatusRequest:
      state_.send(peer).mutable_status_reply()->set_json(recentStatus());
      return true;
    case wire::Message::kPauseRequest:
      pause(message.pause_request().paused());
      state_.send(peer).mutable_pause_reply()->set_paused(state_.paused);
      return true;
    case wire::Message::kRetryRequest: {
      const std::string& cause = message.retry_request().cause();
      const std::int32_t transitions = cause.empty() ? retry() : retryFailed(cause);
      state_.send(peer).mutable_retry_reply()->set_transitions(
          static_cast<std::uint32_t>(transitions));
      return true;
    }
    case wire::Message::kPriorityRequest: {
      const wire::PriorityRequest& asked = message.priority_request();
      const std::string objection = prioritize(asked.space(), asked.priority());
      if (objection.empty()) {
        state_.tables.writePriority(asked.space(), asked.priority());
        state_.chronicle.prioritized(asked.space(), asked.priority());
      }
      state_.send(peer).mutable_priority_reply()->set_objection(objection);
      return true;
    }
    default: return false;
  }
}

void People::measure() {
  const Time now = state_.now;
  pace_.note(now, intake_.converged());
  work_pace_.note(now, intake_.recorded());
  if (!state_.paused && !workers_.registry.all().empty())
    worked_ += std::chrono::duration<double>(now - measured_).count();
  measured_ = now;
  // Limit the rate of forecasts, because each looks at many points.
  constexpr std::chrono::milliseconds at_least{500};
  if (state_.complete || now - forecast_made_ < at_least) return;
  // A forecast costs 0.2 us per point, so one every 20 us per point takes 1 % of a core.
  double points = 0;
  for (const SpacePlan& plan : state_.plans) points += plan.size();
  points = std::min(points, double{most_forecast});
  if (now - forecast_made_ < std::chrono::duration<double>(2e-5 * points)) return;
  forecast_ = forecastOf(state_.problem, state_.plans);
  forecast_made_ = now;
  recorded_then_ = intake_.recorded();
  hindsight_.note(worked_, timeLeft(1, now));
}

std::int32_t People::retry() {
  const auto aside = static_cast<std::int32_t>(workers_.leases.aside().size());
  workers_.retryAside();
  state_.chronicle.retried(aside);
  return aside;
}

/// Drops the recorded failures with this cause. A new Build then makes its plans without them and
/// tries these transitions again. Returns the number of dropped failures.
std::int32_t People::retryFailed(const std::string& cause) {
  const auto which = causeNamed(cause);
  if (!which || state_.turns_since_retry || state_.complete) return 0;
  const std::vector<ResultKey> failed = failedWith(state_.plans, *which);
  if (failed.empty()) return 0;
  state_.store.drop(failed);
  state_.chronicle.retried(std::ssize(failed), cause);
  spdlog::warn("{} attempts that failed with {} are repeated, as an operator requested",
               failed.size(), cause);
  state_.turns_since_retry = 0;
  return static_cast<std::int32_t>(failed.size());
}

/// Sets a priority. Returns why it cannot be set, or an empty string.
std::string People::prioritize(const std::string& name, std::int32_t priority) {
  std::set<std::string> names;
  for (std::uint32_t space = 0; space < state_.plans.size(); ++space) {
    const std::string& row = *names.insert(rowNameOf(state_.problem.scene.active[space])).first;
    if (row == name) workers_.leases.setPriority(space, priority);
  }
  if (!names.contains(name))
    return fmt::format("no space named {}; spaces: {}", printable(name),
                       printable(fmt::format("{}", fmt::join(names, ", ")), 500));
  priorities_[name] = priority;
  recent_status_.clear();
  return "";
}

void People::pause(bool paused) {
  if (paused == state_.paused) return;
  state_.tables.writePaused(paused);
  state_.paused = paused;
  recent_status_.clear();
  state_.chronicle.paused(paused);
}

People::Time People::serversDue() const {
  const auto waits = static_cast<int>(workers_.registry.all().size() / workers_per_wait);
  return servers_written_ +
         (workers_.newcomers ? waits * newcomers_written_after : servers_written_every);
}

void People::writeServers() {
  std::vector<wire::WorkerStatus> rows = workers_.registry.takeDeparted();
  const std::vector<wire::WorkerStatus> present =
      workers_.registry.rows(workers_.leases, state_.now);
  rows.insert(rows.end(), present.begin(), present.end());
  state_.store.checkPresence();
  state_.tables.writeServers(rows);
  state_.tables.writeCounters(state_.counters);
  if (state_.complete || state_.stopping || state_.now - progress_written_ >= servers_written_every)
    writeProgress();
  servers_written_ = state_.now;
  workers_.newcomers = false;
}

void People::writeProgress() {
  state_.tables.writeProgress(
      {state_.store.recorded(),
       toJson(progressOf(state_.problem, state_.store.build(), state_.plans,
                         workers_.registry.kernelFamily(), state_.complete))});
  progress_written_ = state_.now;
}

const std::string& People::recentStatus() {
  // Measured costs of making a status, s per space and per worker. A status is reused for `times`
  // its cost, so that endless requests take 5 % of a core.
  constexpr double by_space = 3e-6, by_worker = 3e-6, times = 20;
  const double cost = by_worker * static_cast<double>(workers_.registry.all().size()) +
                      by_space * static_cast<double>(state_.plans.size());
  const std::chrono::duration<double> good_for(std::max(0.02, times * cost));
  if (recent_status_.empty() || state_.now - recent_status_made_ >= good_for) {
    recent_status_ = toJson(status(state_.now));
    recent_status_made_ = state_.now;
  }
  return recent_status_;
}

double People::timeLeft(double share, Time now) const {
  const double rate = work_pace_.perSecond(now, intake_.recorded());
  if (rate <= 0) return 0;
  // The results recorded since the forecast were among its ready transitions.
  const double ready =
      std::max(1.0, forecast_.ready - static_cast<double>(intake_.recorded() - recorded_then_));
  return (ready + share * forecast_.expected) / rate;
}

void People::addTimeLeft(wire::Status& status, Time now) const {
  if (state_.complete) return status.set_eta_seconds(0);
  const double left = timeLeft(1, now);
  if (left <= 0 || state_.paused) return;
  const double factor = hindsight_.factor(worked_, left);
  status.set_eta_seconds(factor * left);
  status.set_eta_low_seconds(factor * timeLeft(0.5, now));
  status.set_eta_high_seconds(factor * timeLeft(2, now));
}

wire::Status People::status(Time now) const {
  wire::Status status = progressOf(state_.problem, state_.store.build(), state_.plans,
                                   workers_.registry.kernelFamily(), state_.complete);
  addServers(status, workers_.registry.rows(workers_.leases, now), state_.counters);
  status.set_set_aside(static_cast<std::int32_t>(workers_.leases.aside().size()));
  status.set_checks_open(static_cast<std::int32_t>(seconds_.left()));
  status.set_disputed(static_cast<std::int32_t>(seconds_.checks().disputedCount()));
  addKeptOut(status, state_.store.keptOut());
  addDisk(status, state_.store.directory(), state_.store.journalBytes());
  if (!state_.complete) status.set_state(state_.stopping ? "stopping" : "running");
  status.set_paused(state_.paused);
  setPriorities(status, priorities_);
  status.set_recorded(static_cast<std::int32_t>(intake_.recorded()));
  status.set_seconds(std::chrono::duration<double>(now - state_.started).count());
  status.set_configurations_per_second(pace_.perSecond(now, intake_.converged()));
  addTimeLeft(status, now);
  return status;
}

}  // namespace palpate
