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

/// Builds the dataset of a scene while the client runs: `palpate build` on all cores but two, at
/// the lowest priority, so that haptic loop and live solver come first. Has a thread of its own.
class BuildBeside {
 public:
  /// output: the dataset. The build stores its state in OUTPUT.state.
  BuildBeside(std::filesystem::path scene, std::filesystem::path output);
  /// Lets the workers finish their solves for at most 10 s, and ends the build; `palpate build`
  /// continues it.
  ~BuildBeside() = default;

  /// Asks the scheduler to compute these spaces before all others, the first one first. Does not
  /// wait. Any thread.
  void prefer(std::vector<std::string> spaces);
  /// Asks for a dataset of the results so far. Does not wait. Any thread.
  void askForResults();
  /// Returns that dataset once after each request, when it is written; nullopt before. A later
  /// request replaces the file. Any thread.
  std::optional<std::filesystem::path> takeResults();
  /// Returns the exit code of the build; nullopt while it runs. Any thread.
  std::optional<int> exitCode() const;

 private:
  void run(const std::stop_token& stop);
  void passPreference();
  void sealResults();

  using Clock = std::chrono::steady_clock;

  const std::filesystem::path scene_, output_;
  ScratchFolder folder_;  ///< of the dataset of the results so far
  // Used by the thread.
  std::string passed_;            ///< the space that the scheduler prefers
  std::set<std::string> raised_;  ///< spaces that it has preferred at some time
  int priority_ = 0;
  Clock::time_point next_try_, next_seal_;

  mutable std::mutex mutex_;  ///< guards the members below
  std::vector<std::string> preferred_;
  bool asked_ = false;  ///< for the results so far
  std::optional<std::filesystem::path> results_;
  std::optional<int> exit_code_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
