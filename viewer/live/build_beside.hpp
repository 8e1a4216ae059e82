#pragma once

#include <chrono>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

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

  /// Asks the scheduler to compute this space before all others. Does not wait. Any thread.
  void prefer(const std::string& space);
  /// Returns the exit code of the build; nullopt while it runs. Any thread.
  std::optional<int> exitCode() const;

 private:
  void run(const std::stop_token& stop);
  void passPreference();

  using Clock = std::chrono::steady_clock;

  const std::filesystem::path scene_, output_;
  // Used by the thread.
  std::string passed_;  ///< the space that the scheduler prefers
  int priority_ = 0;
  Clock::time_point next_try_;

  mutable std::mutex mutex_;  ///< guards the members below
  std::string preferred_;
  std::optional<int> exit_code_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
