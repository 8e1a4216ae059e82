#include <spdlog/spdlog.h>

#include <algorithm>

#include "common/base/text.hpp"
#include "scheduler/service/coordinator.hpp"

// What people ask and decide: status, time left, pause, priorities, retry, stop.

namespace palpate {

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

/// Now and then: many points are looked at.
void Coordinator::lookAhead(Time now) {
  constexpr std::chrono::milliseconds at_least{500};
  if (complete_ || now - forecast_made_ < at_least) return;
  // Twenty microseconds for what costs a fifth of one.
  double points = 0;
  for (const SpacePlan& plan : plans_) points += plan.size();
  points = std::min(points, double{most_forecast});
  if (now - forecast_made_ < std::chrono::duration<double>(2e-5 * points)) return;
  forecast_ = forecastOf(*problem_, plans_);
  forecast_made_ = now;
  recorded_then_ = recorded_;
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
  if (!which || turns_since_retry_) return 0;
  const std::vector<ResultKey> failed = failedWith(plans_, *which);
  if (failed.empty()) return 0;
  store_->drop(failed);
  chronicle_.retried(std::ssize(failed), cause);
  spdlog::warn("{} attempts that failed with {} are tried again, as an operator asked",
               failed.size(), cause);
  turns_since_retry_ = 0;
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
  drainAll();
  writeServers(now);
}

const std::string& Coordinator::recentStatus(Time now) {
  // s, as it was measured: whoever asks without end costs a twentieth of a processor.
  constexpr double by_space = 3e-6, by_worker = 3e-6, times = 20;
  const double cost = by_worker * static_cast<double>(registry_.all().size()) +
                      by_space * static_cast<double>(plans_.size());
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
  wire::Status status = statusOf(*problem_, plans_);
  addServers(status, registry_.rows(leases_, now), counters_);
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
  status.set_configurations_per_second(pace_.perSecond(now, converged_));
  addTimeLeft(status, now);
  return status;
}

}  // namespace palpate
