#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "scheduler/fleet/launches.hpp"

namespace palpate {

/// How workers are asked of Slurm.
struct SlurmOptions {
  std::string name;                  ///< of the jobs: the build's, so that they are found again
  std::vector<std::string> command;  ///< one worker, as it runs on a node
  std::string endpoint;              ///< where that finds its scheduler
  /// Each may run at most so long; a minute before that, or of short ones in the last quarter, it
  /// is told to end (SIGTERM).
  int minutes = 60;
  std::string constraint;         ///< features of nodes; empty: any
  std::string log = "/dev/null";  ///< a file name as sbatch --output takes it
  std::vector<std::string> more;  ///< options of sbatch, as they are
};

/// What Slurm has of one name. A job that it ended and still cleans up after is in none of it.
struct SlurmJobs {
  struct Queued {
    std::string id, reason;  ///< in Slurm's words
  };
  std::vector<Queued> queued;              ///< elements of arrays that have not started
  std::vector<Launches::Running> running;  ///< those that started and have not ended
  std::vector<Launches::Ended> ended;      ///< the first first; as long as Slurm remembers them
  std::vector<std::string> elsewhere;      ///< queued or running, of another endpoint: their ids

  /// Of the queued ones, by reason.
  std::map<std::string, int> reasons() const;
  /// `text` as Slurm::jobs() has squeue write it. Lines that make no sense are passed over.
  static SlurmJobs parsed(const std::string& text, const std::string& endpoint);
};

/// Workers as elements of array jobs of one name, by the programs of Slurm: sbatch, squeue and
/// scancel. Nothing that matters is remembered: whoever makes another of the same name goes on with
/// its jobs. Error when a program cannot be run or says no, with what it said; bad input when it
/// will say so until an option is changed.
class Slurm {
 public:
  explicit Slurm(SlurmOptions options) : options_(std::move(options)) {}

  SlurmJobs jobs() const;
  /// More workers of one core each, on no node of `but_on`. Arrays are as long as Slurm takes them.
  void submit(int workers, const std::set<std::string>& but_on = {});
  /// These elements. Those that run are told to end and have their time for it.
  void cancel(const std::vector<std::string>& ids) const;
  /// Everything of this name.
  void cancelAll() const;

  /// The batch script of so many workers, in the words of sbatch.
  std::string script(int workers, const std::set<std::string>& but_on = {}) const;
  /// The file that this element writes to.
  std::string logOf(const std::string& id) const;

 private:
  SlurmOptions options_;
  int longest_array_ = 1000;  ///< Slurm's MaxArraySize is 1001 unless somebody changed it
};

}  // namespace palpate
