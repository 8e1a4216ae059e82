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

/// Returns the exit code of a child that has ended; nullopt while it runs. Error if the system
/// refuses.
std::optional<int> exitCodeOf(pid_t child) {
  int status = 0;
  const pid_t ended = waitpid(child, &status, WNOHANG);
  if (ended < 0) throw failure("cannot wait for palpate build: {}", errnoText());
  if (ended == 0) return std::nullopt;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
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

void BuildBeside::prefer(const std::string& space) {
  const std::lock_guard lock(mutex_);
  preferred_ = space;
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

/// Gives the preferred space a higher priority than all spaces before. A build that does not listen
/// yet refuses, and is asked again.
void BuildBeside::passPreference() {
  std::string space;
  {
    const std::lock_guard lock(mutex_);
    if (preferred_ == passed_ || Clock::now() < next_try_) return;
    space = preferred_;
  }
  next_try_ = Clock::now() + 1s;
  try {
    const Ran done = runToItsEnd({.words = {programBeside("palpate").string(), "priority",
                                            stateOf(output_), space, std::to_string(++priority_)},
                                  .package = "palpate"});
    if (done.exit_code == 0) passed_ = space;
  } catch (const Error& error) {
    spdlog::debug("{}", error.what());  // for instance a scheduler that answers too late
  }
}

}  // namespace palpate
