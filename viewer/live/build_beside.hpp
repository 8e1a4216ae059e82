#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "common/base/scratch_folder.hpp"

namespace palpate {

/// Builds the dataset of a scene while the client runs. Runs `palpate build` at the lowest priority
/// on all cores but two, which the haptic loop and live solver need. Has a thread of its own.
class BuildBeside {
 public:
  /// output: the dataset. The build stores its state in OUTPUT.state.
  BuildBeside(std::filesystem::path scene, std::filesystem::path output);
  /// Gives the workers at most 10 s to finish their solves, then ends the build. `palpate build`
  /// can continue it.
  ~BuildBeside() = default;

  /// Asks the scheduler to compute these spaces before all others, the first one first. Does not
  /// wait. Any thread.
  void prefer(std::vector<std::string> spaces);
  /// Asks for a dataset of the results so far. Does not wait. Any thread.
  void askForResults();
  /// Returns the file of that dataset once after each askForResults(), when it is written; nullopt
  /// before and after. A later request replaces the file. Any thread.
  std::optional<std::filesystem::path> takeResults();
  /// Returns the exit code of the build; nullopt while it runs. Any thread.
  std::optional<int> exitCode() const;

 private:
  void run(const std::stop_token& stop);
  void passPreference();
  void sealResults();

  using Clock = std::chrono::steady_clock;

  const std::filesystem::path scene_, output_;
  ScratchFolder folder_;  ///< contains the dataset of the results so far
  // Used by the thread.
  std::string passed_;            ///< the last space whose priority was raised
  std::set<std::string> raised_;  ///< all spaces whose priority was raised
  int priority_ = 0;
  Clock::time_point next_try_, next_seal_;

  mutable std::mutex mutex_;  ///< guards the members below
  std::vector<std::string> preferred_;
  bool asked_ = false;  ///< whether askForResults() was called and the dataset is not written
  std::optional<std::filesystem::path> results_;
  std::optional<int> exit_code_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
