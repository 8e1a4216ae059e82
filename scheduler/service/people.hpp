#pragma once

#include "scheduler/plan/forecast.hpp"
#include "scheduler/service/intake.hpp"
#include "scheduler/service/status.hpp"

namespace palpate {

/// What people are told, by messages and by the tables, and what they decide, but for the stop.
/// One thread; the references must outlive it.
class People {
 public:
  using Time = ServiceState::Time;
  People(ServiceState& state, Workers& workers, const SecondSolves& seconds, const Intake& intake);

  /// Does what people ask for; false: it is none of that.
  bool answer(const Incoming& incoming);
  void pause(bool paused);
  wire::Status status(Time now) const;

  /// Measures how fast it goes, and looks ahead now and then.
  void measure();
  /// When the table of servers is to be written.
  Time serversDue() const;
  void writeServers();
  /// What is told of the directory when nobody works there.
  void writeProgress();

 private:
  const std::string& recentStatus();
  void addTimeLeft(wire::Status& status, Time now) const;
  std::int32_t retry();
  std::int32_t retryFailed(const std::string& cause);
  std::string prioritize(const std::string& name, std::int32_t priority);

  ServiceState& state_;
  Workers& workers_;
  const SecondSolves& seconds_;
  const Intake& intake_;
  std::string recent_status_;  ///< JSON
  Time recent_status_made_;
  Time servers_written_, progress_written_;
  Pace pace_;       ///< of equilibria
  Pace work_pace_;  ///< of results, whatever they say
  Forecast forecast_;
  Time forecast_made_;
  std::int64_t recorded_then_ = 0;
  std::map<std::string, std::int32_t> priorities_;  ///< by row of a status
};

}  // namespace palpate
