#include "common/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "common/base/machine.hpp"

namespace palpate {

void inParallel(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> failed = false;
  std::mutex mutex;  // guards the variables below
  std::size_t first = count;
  std::exception_ptr error;
  const auto work = [&] {
    // Run every task whose number was taken, even if another task fails meanwhile. Otherwise a task
    // with a lower number than the failed one could be left out.
    while (!failed) {
      const std::size_t n = next++;
      if (n >= count) return;
      try {
        task(n);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        failed = true;
        if (n > first) continue;
        first = n;
        error = std::current_exception();
      }
    }
  };
  {
    // The end of this block joins the threads, before `error` is read.
    std::vector<std::jthread> threads;
    const std::size_t wanted = std::min<std::size_t>(count, coreCount());
    while (threads.size() + 1 < wanted) threads.emplace_back(work);
    work();
  }
  if (error) std::rethrow_exception(error);
}

}  // namespace palpate
