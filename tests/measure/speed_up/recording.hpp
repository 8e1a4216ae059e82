#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "common/problem/problem.hpp"
#include "scheduler/state/job_store.hpp"

namespace palpate::speed_up {

/// A build that was done once: what every transition came to, and how long that took. Whoever
/// builds it again asks for the same transitions, because a plan is a function of their outcomes.
class Recording {
 public:
  struct Solve {
    wire::Result result;  ///< as its worker said it
    Outcome outcome;      ///< what that says
    std::string payload;
    double seconds = 0;  ///< of a worker
  };

  /// Of a state directory in which nobody works. Error (bad input) when it is none.
  explicit Recording(const std::filesystem::path& directory);

  const Problem& problem() const { return problem_; }
  const std::string& kernelFamily() const { return kernel_family_; }
  std::size_t size() const { return solves_.size(); }
  /// Of all solves together.
  double seconds() const { return seconds_; }
  double longest() const;
  /// What is recorded as longer took that long: its process was stopped, or had no processor.
  void cutAt(double longest_seconds);
  /// Makes all solves longer, or shorter, by one factor, so that they take so long on average: a
  /// finer mesh, or the same without the other programs that ran when it was recorded.
  void scaleTo(double mean_seconds);

  /// Error when the build did not come to that transition: it is not the recording of one that went
  /// to its end, or of another version.
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
