#pragma once

#include <map>
#include <string>
#include <vector>

namespace palpate {

/// How workers are asked of Slurm.
struct SlurmOptions {
  std::string name;                  ///< of the jobs: the build's, so that they are found again
  std::vector<std::string> command;  ///< one worker, as it runs on a node
  /// Each may run at most so long; a minute before that, or of short ones in the last quarter, it
  /// is told to end (SIGTERM).
  int minutes = 60;
  std::string constraint;         ///< features of nodes; empty: any
  std::string log = "/dev/null";  ///< a file name as sbatch --output takes it
  std::vector<std::string> more;  ///< options of sbatch, as they are
};

/// Workers as elements of array jobs of one name, by the programs of Slurm: sbatch, squeue and
/// scancel. Nothing is remembered: whoever makes another of the same name goes on with its jobs.
/// Error when a program cannot be run or says no, with what it said.
class Slurm {
 public:
  explicit Slurm(SlurmOptions options) : options_(std::move(options)) {}

  struct Jobs {
    std::vector<std::string> queued;        ///< ids of elements that have not started
    int running = 0;                        ///< those that started and have not ended
    std::map<std::string, int> why_queued;  ///< by Slurm's reason
  };
  Jobs jobs() const;
  /// More workers of one core each.
  void submit(int workers) const;
  /// These elements. Those that run are told to end and have their time for it.
  void cancel(const std::vector<std::string>& ids) const;
  /// Everything of this name.
  void cancelAll() const;

  /// The batch script of so many workers, in the words of sbatch.
  std::string script(int workers) const;

 private:
  SlurmOptions options_;
};

}  // namespace palpate
