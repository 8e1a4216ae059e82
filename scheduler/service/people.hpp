#pragma once

#include "scheduler/plan/forecast.hpp"
#include "scheduler/service/intake.hpp"
#include "scheduler/service/pace.hpp"
#include "scheduler/service/status.hpp"

namespace palpate {

/// Answers the requests of operators and observers, writes progress to the tables, and carries out
/// all operator decisions except stop. One thread; the references must outlive this object.
class People {
 public:
  using Time = ServiceState::Time;
  People(ServiceState& state, Workers& workers, const SecondSolves& seconds, const Intake& intake);

  /// Handles a request of an operator or observer. Returns false for other messages.
  bool answer(const Incoming& incoming);
  void pause(bool paused);
  wire::Status status(Time now) const;

  /// Updates the measured rate of results and, from time to time, the forecast of remaining work.
  void measure();
  /// Time when the table of servers is written next.
  Time serversDue() const;
  void writeServers();
  /// Stores the progress in the tables, for users who ask when no scheduler runs.
  void writeProgress();

 private:
  const std::string& recentStatus();
  /// Returns the estimated time left, s, not corrected by Hindsight; 0 while it is unknown. Assumes
  /// that `share` * Forecast::expected attempts will become ready later.
  double timeLeft(double share, Time now) const;
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
  Pace pace_;       ///< rate of equilibria
  Pace work_pace_;  ///< rate of all results
  Forecast forecast_;
  Time forecast_made_, measured_;
  std::int64_t recorded_then_ = 0;
  double worked_ = 0;  ///< time worked in this run, s (Hindsight::note)
  Hindsight hindsight_;
  std::map<std::string, std::int32_t> priorities_;  ///< by name of a status row
};

}  // namespace palpate
