#pragma once

namespace palpate::test {

/// Calls by the counting thread.
struct CallCounts {
  long allocations = 0;  ///< malloc and related functions, including operator new
  long frees = 0;
  long locks = 0;   ///< mutexes, read-write locks, conditions, semaphores
  long prints = 0;  ///< write(), fwrite()
};

/// Counts the calls of this thread between startCounting() and stopCounting() in the C library
/// itself, whose functions counted_calls.cpp replaces in the program. One thread at a time.
void startCounting() noexcept;
CallCounts stopCounting() noexcept;

}  // namespace palpate::test
