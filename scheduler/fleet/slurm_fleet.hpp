#pragma once

#include "common/base/error.hpp"
#include "common/base/program.hpp"
#include "scheduler/fleet/fleet.hpp"
#include "scheduler/fleet/slurm.hpp"

namespace palpate {

struct SlurmFleetOptions : FleetOptions {
  FleetLimits limits;
  SlurmOptions slurm;
  int leave_idle_s = 300;
  bool cancel = false;
};

/// Keeps as many workers of Slurm as a build can use, as long as it goes on. One thread.
class SlurmFleet {
 public:
  /// `options` must outlive it.
  explicit SlurmFleet(const SlurmFleetOptions& options);

  /// Until the build is complete (done), the scheduler says nothing any more (failed), or a signal
  /// comes (interrupted): then the jobs stay. Error (bad input) when Slurm takes no job of these
  /// options, and has none.
  ExitCode run();
  /// Cancels all jobs of the build and waits until they are gone; tries again while Slurm does not
  /// answer. Error when they are not gone in FleetOptions::give_up_s.
  void end();

 private:
  using Clock = std::chrono::steady_clock;

  void turn(const std::optional<wire::Status>& status);
  void submit(int more);
  bool endsIt(const Error& error) const;
  int moreFor(const SlurmJobs& jobs, const wire::Status& status);
  bool isUnheard(const SlurmJobs& jobs, const wire::Status& status);
  bool cancelUnwanted(const SlurmJobs& jobs, bool nodes_changed);
  void tell(const SlurmJobs& jobs, int more, const std::string& why);
  void tellLaunches(const Launches::Change& change);
  ExitCode finish(const char* why);
  ExitCode leave() const;

  const SlurmFleetOptions& options_;
  Slurm engine_;
  FleetWatch watch_;
  Launches launches_;
  Backoff refused_;
  bool taken_ = false;  ///< Slurm took a job, or has some
  std::string told_;
  bool told_unheard_ = false;
};

}  // namespace palpate
