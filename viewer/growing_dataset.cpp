#include "viewer/growing_dataset.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>

#include "common/base/child_process.hpp"
#include "common/base/error.hpp"
#include "common/base/foreign_program.hpp"
#include "common/base/machine.hpp"
#include "common/base/program.hpp"
#include "common/base/text.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto build_poll = 100ms;
/// Longest wait for the workers to finish their solves.
constexpr auto end_patience = 10s;
/// Cores that the build leaves to the haptic loop and the live solver.
constexpr unsigned cores_left = 2;
/// Shortest time between two loads, as a multiple of the time that a load takes.
constexpr int rest_of_loads = 4;
/// Number of guessed sites around the finger that the build computes first. The force at a place
/// depends on about this many sites.
constexpr std::size_t preferred_sites = 12;

std::string stateOf(const std::filesystem::path& output) { return output.string() + ".state"; }

/// Runs a verb of palpate. Returns whether it succeeded.
bool palpate(std::vector<std::string> words) {
  words.insert(words.begin(), programBeside("palpate").string());
  try {
    const Ran done = runToItsEnd({.words = std::move(words), .package = "palpate"});
    if (done.exit_code != 0) spdlog::debug("{}", done.err);  // for instance no results yet
    return done.exit_code == 0;
  } catch (const Error& error) {
    spdlog::debug("{}", error.what());  // for instance a scheduler that answers too late
    return false;
  }
}

}  // namespace

GrowingDataset::GrowingDataset(std::filesystem::path scene, std::filesystem::path output,
                               std::vector<std::filesystem::path> files, HapticModelOptions options)
    : scene_(std::move(scene)),
      output_(std::move(output)),
      files_(std::move(files)),
      options_(std::move(options)) {
  options_.stop = no_more_loads_.get_token();
  thread_ = std::jthread([this](const std::stop_token& stop) {
    try {
      run(stop);
    } catch (const std::exception& error) {
      spdlog::warn("{}", error.what());
    }
  });
}

void GrowingDataset::prefer(const HapticModel& model, const Eigen::Vector3d& place) {
  std::map<double, std::string> by_distance;
  for (std::size_t s = 0; s < model.spaces().size(); ++s) {
    const ActivePatch& site = model.spaces()[s].patch;
    if (model.isGuess(s)) by_distance[(site.finger->center - place).norm()] = site.name;
  }
  const std::lock_guard lock(mutex_);
  preferred_.clear();
  for (const auto& [distance, name] : by_distance)
    if (preferred_.size() < preferred_sites) preferred_.push_back(name);
}

std::unique_ptr<LoadedModels> GrowingDataset::takeNewer() {
  const std::lock_guard lock(mutex_);
  return std::exchange(newer_, nullptr);
}

void GrowingDataset::stopLoading() {
  no_more_loads_.request_stop();
  const std::lock_guard waits(loading_);
}

void GrowingDataset::run(const std::stop_token& stop) {
  giveWay();  // the build inherits the priority
  const unsigned workers = std::max(cores_left + 1, coreCount()) - cores_left;
  ChildProcess build({programBeside("palpate").string(), "build", scene_.string(), "-o",
                      output_.string(), "--state", stateOf(output_), "-j", std::to_string(workers),
                      "-q"});
  while (build.running() && !stop.stop_requested()) {
    passPreference();
    if (Clock::now() >= next_load_) loadResults();
    std::this_thread::sleep_for(build_poll);
  }
  if (build.running()) {
    spdlog::info("{} is not complete; continue with: palpate build {} -o {}", output_.string(),
                 shellWord(scene_.string()), shellWord(output_.string()));
    return build.terminate(end_patience);
  }
  // Exit code 3: complete, but some points have no equilibrium.
  if (build.exitCode() != 0 && build.exitCode() != 3)
    return spdlog::warn("the build of {} has ended with {}; its messages are above",
                        output_.string(), build.how());
  spdlog::info("{} is complete", output_.string());
  load(output_);
}

/// Raises the priority of one preferred space above all priorities so far. Chooses the farthest
/// space that was not raised yet; if there is none, the nearest. If the build does not accept
/// commands yet, a later call tries again.
void GrowingDataset::passPreference() {
  std::string space;
  {
    const std::lock_guard lock(mutex_);
    if (preferred_.empty() || Clock::now() < next_try_) return;
    const auto isNew = [&](const std::string& each) { return !raised_.contains(each); };
    const auto farthest = std::find_if(preferred_.rbegin(), preferred_.rend(), isNew);
    space = farthest != preferred_.rend() ? *farthest : preferred_.front();
  }
  if (space == passed_) return;
  next_try_ = Clock::now() + 1s;
  if (!palpate({"priority", stateOf(output_), space, std::to_string(++priority_)})) return;
  next_try_ = Clock::now() + 300ms;
  raised_.insert(space);
  passed_ = space;
}

/// Loads the results so far. If the build has none yet, a later call tries again.
void GrowingDataset::loadResults() {
  next_load_ = Clock::now() + 1s;
  const std::filesystem::path results = folder_ / "results.h5";
  if (!palpate({"seal", stateOf(output_), "-o", results.string(), "--replace", "-q"})) return;
  const auto began = Clock::now();
  load(results);
  next_load_ = Clock::now() + rest_of_loads * (Clock::now() - began);
}

/// Loads a dataset if it is complete or has fewer guesses than the newest models.
void GrowingDataset::load(const std::filesystem::path& dataset) {
  const std::lock_guard loading(loading_);
  if (no_more_loads_.stop_requested()) return;
  files_.front() = dataset;
  try {
    auto models = std::make_unique<LoadedModels>(files_, options_);
    if (dataset != output_ && models->first().guesses() >= guesses_) return;
    guesses_ = models->first().guesses();
    const auto goes_on = [&](auto&&...) { return !no_more_loads_.stop_requested(); };
    if (!models->prepareFirst(goes_on, /*log=*/false)) return;
    const std::lock_guard lock(mutex_);
    newer_ = std::move(models);
  } catch (const std::exception& error) {
    if (!no_more_loads_.stop_requested())
      spdlog::warn("cannot use the results of the build so far: {}", error.what());
  }
}

}  // namespace palpate
