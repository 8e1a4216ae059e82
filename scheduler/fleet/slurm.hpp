#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "scheduler/fleet/launches.hpp"

namespace palpate {

/// Options of the jobs that run workers under Slurm.
struct SlurmOptions {
  std::string name;  ///< name of the jobs, made from the build id so that they are found again
  std::vector<std::string> command;  ///< command of one worker on a node
  std::string endpoint;              ///< address of its scheduler
  /// Time limit of each job. SIGTERM comes one minute before the limit, or, if the limit is shorter
  /// than four minutes, when a quarter of it is left. Slurm may send it a minute early.
  int minutes = 60;
  std::string constraint;         ///< required features of nodes; may be empty
  std::string log = "/dev/null";  ///< file name, in the syntax of sbatch --output
  std::vector<std::string> more;  ///< further options of sbatch, unchanged
};

/// The jobs of one name that Slurm has. Excludes ended jobs that Slurm is still cleaning up.
struct SlurmJobs {
  struct Queued {
    std::string id, reason;  ///< reason in Slurm's words
  };
  std::vector<Queued> queued;              ///< array elements that have not started
  std::vector<Launches::Running> running;  ///< array elements that have started and not ended
  std::vector<Launches::Ended> ended;      ///< oldest first; Slurm forgets them after a while
  std::vector<std::string> elsewhere;      ///< ids of queued or running jobs for another endpoint

  /// Returns the number of queued jobs by reason.
  std::map<std::string, int> reasons() const;
  /// Parses `text`, output of squeue in the format that Slurm::jobs() asks for. Skips invalid
  /// lines.
  static SlurmJobs parsed(const std::string& text, const std::string& endpoint);
};

/// Runs workers as elements of array jobs of one name, through sbatch, squeue and scancel. Keeps no
/// essential state: a new object with the same name takes over the jobs. Functions throw Error,
/// with the program's message, if a program cannot run or refuses. The error is of kind bad input
/// if the program would refuse until an option is changed.
class Slurm {
 public:
  explicit Slurm(SlurmOptions options) : options_(std::move(options)) {}

  SlurmJobs jobs() const;
  /// Submits workers of one core each, which run on any nodes except those in `but_on`. Uses the
  /// longest arrays that Slurm accepts.
  void submit(int workers, const std::set<std::string>& but_on = {});
  /// Cancels these array elements. Running elements get SIGTERM and time to finish.
  void cancel(const std::vector<std::string>& ids) const;
  /// Cancels all jobs of this name.
  void cancelAll() const;

  /// Returns the batch script for this number of workers.
  std::string script(int workers, const std::set<std::string>& but_on = {}) const;
  /// Returns the log file of the array element `id`.
  std::string logOf(const std::string& id) const;

 private:
  SlurmOptions options_;
  int longest_array_ = 1000;  ///< Slurm's default MaxArraySize is 1001
};

}  // namespace palpate
