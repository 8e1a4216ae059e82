#include "common/base/thread_pool.hpp"

#include <unistd.h>

#include "common/base/assertion.hpp"

namespace palpate {

ThreadPool::ThreadPool(std::size_t threads)
    : process_(getpid()), threads_(std::make_unique<std::vector<std::jthread>>()) {
  PALPATE_ASSERT(threads > 0, "a pool has at least the calling thread");
  const auto untilStopped = [this] {
    for (int seen = 0; !stop_;) {
      wakes_.wait(seen);
      seen = wakes_;
      work();
    }
  };
  try {
    while (threads_->size() + 1 < threads) threads_->emplace_back(untilStopped);
  } catch (...) {
    end();
    throw;
  }
}

ThreadPool::~ThreadPool() {
  end();
  // The threads of a parent process do not exist here, so they can be neither joined nor detached.
  if (getpid() != process_) static_cast<void>(threads_.release());
}

void ThreadPool::end() noexcept {
  stop_ = true;
  ++wakes_;
  wakes_.notify_all();
}

void ThreadPool::run(std::size_t count, const std::function<void(std::size_t)>& task) noexcept {
  task_ = &task;
  not_ended_ = static_cast<std::ptrdiff_t>(count);
  not_taken_ = static_cast<std::ptrdiff_t>(count);
  if (count > 1) {
    ++wakes_;
    wakes_.notify_all();
  }
  work();
  for (std::ptrdiff_t left = not_ended_; left != 0; left = not_ended_) not_ended_.wait(left);
}

void ThreadPool::work() noexcept {
  for (std::ptrdiff_t n = not_taken_--; n > 0; n = not_taken_--) {
    (*task_)(static_cast<std::size_t>(n - 1));
    if (--not_ended_ == 0) not_ended_.notify_one();
  }
}

}  // namespace palpate
