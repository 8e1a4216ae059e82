#pragma once

#include <limits>
#include <mutex>
#include <set>
#include <thread>

#include "common/base/scratch_folder.hpp"
#include "viewer/loaded_models.hpp"

namespace palpate {

/// A dataset that grows while its scene is touched. `palpate build` computes it at the lowest
/// priority, on all cores but two, which the haptic loop and the live solver need. Every few
/// seconds, newer models with the sites finished so far are loaded. Has a thread of its own; the
/// object belongs to one thread.
class GrowingDataset {
 public:
  /// output: the dataset. The build stores its state in OUTPUT.state. files: the files of the run,
  /// in which the dataset replaces the first. options: how to load them.
  GrowingDataset(std::filesystem::path scene, std::filesystem::path output,
                 std::vector<std::filesystem::path> files, HapticModelOptions options);
  /// Gives the workers at most 10 s to finish their solves, then ends the build. Logs the command
  /// that continues the build.
  ~GrowingDataset() { stopLoading(); }

  /// Asks the build to compute the guessed sites of `model` (the scene's) that are nearest to a
  /// place, m, before all others. Does not wait.
  void prefer(const HapticModel& model, const Eigen::Vector3d& place);
  /// Returns the newest models once, when they are loaded; otherwise null.
  std::unique_ptr<LoadedModels> takeNewer();
  /// Ends a load within tens of milliseconds, and loads no more. HDF5 is then free for this thread.
  void stopLoading();

 private:
  using Clock = std::chrono::steady_clock;

  void run(const std::stop_token& stop);
  void passPreference();
  void loadResults();
  void load(const std::filesystem::path& dataset);

  const std::filesystem::path scene_, output_;
  std::stop_source no_more_loads_;
  // Used by the thread.
  std::vector<std::filesystem::path> files_;
  HapticModelOptions options_;
  ScratchFolder folder_;  ///< contains the dataset of the results so far
  std::size_t guesses_ = std::numeric_limits<std::size_t>::max();  ///< of the newest models
  std::string passed_;            ///< the last space whose priority was raised
  std::set<std::string> raised_;  ///< all spaces whose priority was raised
  int priority_ = 0;
  Clock::time_point next_try_, next_load_;

  std::mutex loading_;  ///< held during a load
  std::mutex mutex_;    ///< guards the members below
  std::vector<std::string> preferred_;
  std::unique_ptr<LoadedModels> newer_;

  std::jthread thread_;  ///< last member: ends before the members that it uses are destroyed
};

}  // namespace palpate
