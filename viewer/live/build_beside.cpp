#include "viewer/live/build_beside.hpp"

#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>

#include <algorithm>

#include "common/base/child_process.hpp"
#include "common/base/error.hpp"
#include "common/base/foreign_program.hpp"
#include "common/base/machine.hpp"
#include "common/base/program.hpp"

namespace palpate {
namespace {

using namespace std::chrono_literals;

constexpr auto build_poll = 100ms;
/// Longest wait for the workers to finish their solves.
constexpr auto end_patience = 10s;
/// Cores that the build leaves to the haptic loop and the live solver.
constexpr unsigned cores_left = 2;

std::string stateOf(const std::filesystem::path& output) { return output.string() + ".state"; }

/// Returns the exit code of a child that has ended; nullopt while it runs. Error if waitpid()
/// fails.
std::optional<int> exitCodeOf(pid_t child) {
  int status = 0;
  const pid_t ended = waitpid(child, &status, WNOHANG);
  if (ended < 0) throw failure("cannot wait for palpate build: {}", errnoText());
  if (ended == 0) return std::nullopt;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

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

BuildBeside::BuildBeside(std::filesystem::path scene, std::filesystem::path output)
    : scene_(std::move(scene)),
      output_(std::move(output)),
      thread_([this](const std::stop_token& stop) {
        try {
          run(stop);
        } catch (const std::exception& error) {
          spdlog::warn("{}", error.what());
        }
      }) {}

void BuildBeside::prefer(std::vector<std::string> spaces) {
  const std::lock_guard lock(mutex_);
  preferred_ = std::move(spaces);
}

void BuildBeside::askForResults() {
  const std::lock_guard lock(mutex_);
  asked_ = true;
}

std::optional<std::filesystem::path> BuildBeside::takeResults() {
  const std::lock_guard lock(mutex_);
  return std::exchange(results_, std::nullopt);
}

std::optional<int> BuildBeside::exitCode() const {
  const std::lock_guard lock(mutex_);
  return exit_code_;
}

void BuildBeside::run(const std::stop_token& stop) {
  giveWay();  // the build inherits the priority
  const unsigned workers = std::max(cores_left + 1, coreCount()) - cores_left;
  const pid_t child = startChild({programBeside("palpate").string(), "build", scene_.string(), "-o",
                                  output_.string(), "--state", stateOf(output_), "-j",
                                  std::to_string(workers), "-q"});
  std::optional<int> code;
  while (!stop.stop_requested() && !(code = exitCodeOf(child))) {
    passPreference();
    sealResults();
    std::this_thread::sleep_for(build_poll);
  }
  if (!code) kill(child, SIGTERM);
  for (auto waited = 0ms; !code && !(code = exitCodeOf(child)); waited += build_poll) {
    if (waited == end_patience) kill(child, SIGKILL);
    std::this_thread::sleep_for(build_poll);
  }
  const std::lock_guard lock(mutex_);
  exit_code_ = code;
}

/// Raises the priority of one preferred space above all priorities so far. Chooses the farthest
/// space that was not raised yet; if there is none, the nearest. If the build does not accept
/// commands yet, a later call tries again.
void BuildBeside::passPreference() {
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

/// Writes the dataset of the results so far, if it was asked for. If the build has no results yet,
/// a later call tries again.
void BuildBeside::sealResults() {
  {
    const std::lock_guard lock(mutex_);
    if (!asked_ || Clock::now() < next_seal_) return;
  }
  next_seal_ = Clock::now() + 1s;
  const std::filesystem::path results = folder_ / "results.h5";
  if (!palpate({"seal", stateOf(output_), "-o", results.string(), "--replace", "-q"})) return;
  const std::lock_guard lock(mutex_);
  asked_ = false;
  results_ = results;
}

}  // namespace palpate
