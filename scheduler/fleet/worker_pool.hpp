#pragma once

#include <chrono>

#include "common/base/child_process.hpp"

namespace palpate {

/// Local worker or ssh processes. They die with this process, even if it is killed. Use from the
/// constructing thread only: the kernel ties a child's life to the thread that forked it.
class WorkerPool {
 public:
  struct Ended {
    pid_t pid = 0;
    std::string how;  ///< "exit code 1", "signal 9 (Killed)"
  };

  /// `command` is the program and its arguments. Starts no process.
  explicit WorkerPool(std::vector<std::string> command) : command_(std::move(command)) {}
  /// Terminates and reaps the processes that still run.
  ~WorkerPool() { terminate(std::chrono::milliseconds(0)); }
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// Starts one more process. Throws Error if that fails.
  void start() { running_.push_back(startChild(command_)); }
  /// Returns the processes that ended since the last call.
  std::vector<Ended> reap();
  std::size_t running() const { return running_.size(); }
  /// Sends SIGTERM, and after `grace` SIGKILL. Returns when no process is left.
  void terminate(std::chrono::milliseconds grace);

 private:
  std::vector<std::string> command_;
  std::vector<pid_t> running_;
};

}  // namespace palpate
