#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace palpate {

/// Threads that sleep between calls, for tasks that are too short to start threads for them.
///
/// A forked child has none of its parent's threads: run() then does all tasks in the calling one.
class ThreadPool {
 public:
  /// threads: at least 1, including the one that calls run(). Throws std::system_error if the
  /// system refuses a thread.
  explicit ThreadPool(std::size_t threads);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Runs task(0), ..., task(count - 1) on all threads, and returns when all tasks have ended. Each
  /// thread takes the next task as soon as it is free. Does not wait for threads that wake up late.
  /// `task` must not throw. Does not allocate. One thread at a time may call.
  void run(std::size_t count, const std::function<void(std::size_t)>& task) noexcept;

 private:
  void work() noexcept;
  void end() noexcept;

  const pid_t process_;
  const std::function<void(std::size_t)>* task_ = nullptr;
  /// Number of tasks that no thread has taken, or negative. A thread that decrements it from n > 0
  /// has taken task n - 1, and run() does not return before that task has ended.
  std::atomic<std::ptrdiff_t> not_taken_ = 0;
  std::atomic<std::ptrdiff_t> not_ended_ = 0;  ///< number of tasks that have not ended
  std::atomic<int> wakes_ = 0;                 ///< grows to wake the threads
  std::atomic<bool> stop_ = false;
  std::unique_ptr<std::vector<std::jthread>> threads_;
};

}  // namespace palpate
