#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/problem/problem.hpp"
#include "scheduler/state/job_store.hpp"

namespace palpate::speed_up {

/// A completed build: the outcome and duration of every transition. Another build requests the same
/// transitions, because a plan is a function of their outcomes.
class Recording {
 public:
  struct Solve {
    wire::Result result;  ///< as delivered by its worker
    Outcome outcome;      ///< decoded from the result
    std::string payload;
    double seconds = 0;  ///< time that the worker needed
  };

  /// Reads a state directory without a running scheduler. Throws (bad input) if the directory is
  /// not one.
  explicit Recording(const std::filesystem::path& directory);

  const Problem& problem() const { return problem_; }
  const std::string& kernelFamily() const { return kernel_family_; }
  std::size_t size() const { return solves_.size(); }
  /// Sum over all solves.
  double seconds() const { return seconds_; }
  double longest() const;
  /// Limits the recorded times, because longer solves were suspended, or waited for a processor.
  void cutAt(double longest_seconds);
  /// Scales the times of all solves by one factor, so that their mean is `mean_seconds`. Use it to
  /// represent a finer mesh, or to remove the effect of other programs during the recording.
  void scaleTo(double mean_seconds);

  /// Throws if the build does not contain the transition, because it is incomplete or of another
  /// version.
  const Solve& find(const ResultKey& key) const;

 private:
  std::filesystem::path directory_;
  StoredTables tables_;
  Problem problem_;
  std::string kernel_family_;
  std::map<ResultKey, Solve> solves_;
  double seconds_ = 0;
};

}  // namespace palpate::speed_up
