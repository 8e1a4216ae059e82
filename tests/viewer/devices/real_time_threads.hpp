#pragma once

#include <sched.h>

#include <filesystem>
#include <string>

namespace palpate::test {

/// Number of threads of this program with SCHED_FIFO and this priority.
inline int threadsWith(int priority) {
  int count = 0;
  for (const auto& task : std::filesystem::directory_iterator("/proc/self/task")) {
    const pid_t thread = std::stoi(task.path().filename().string());
    sched_param found{};
    if (sched_getscheduler(thread) == SCHED_FIFO && sched_getparam(thread, &found) == 0)
      count += found.sched_priority == priority ? 1 : 0;
  }
  return count;
}

}  // namespace palpate::test
