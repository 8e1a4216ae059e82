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

/// Keeps as many workers under Slurm as the build can use, until the build ends. One thread.
class SlurmFleet {
 public:
  /// `options` must outlive this object.
  explicit SlurmFleet(const SlurmFleetOptions& options);

  /// Runs until the build is complete (done), the scheduler is silent for give_up_s (failed), or a
  /// signal comes (interrupted; the jobs stay). Throws Error (bad input) if Slurm refuses these
  /// options and has no job of the build.
  ExitCode run();
  /// Cancels all jobs of the build and waits until they are gone. Retries while Slurm does not
  /// answer. Throws Error if jobs are left after FleetOptions::give_up_s.
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
  bool taken_ = false;  ///< Slurm has accepted a job, or has jobs of this name
  std::string told_;
  bool told_unheard_ = false;
};

}  // namespace palpate
