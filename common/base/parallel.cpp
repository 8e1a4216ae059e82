#include "common/base/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

#include "common/base/machine.hpp"

namespace palpate {

void inParallel(std::size_t count, const std::function<void(std::size_t)>& task) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> failed = false;
  // Written by the thread that sets `failed`; read after all threads have ended.
  std::exception_ptr error;
  const auto work = [&] {
    for (std::size_t n = next++; n < count && !failed; n = next++) try {
        task(n);
      } catch (...) {
        if (!failed.exchange(true)) error = std::current_exception();
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
