#pragma once

namespace palpate::test {

/// Calls of the thread that asked for them.
struct CallCounts {
  long allocations = 0;  ///< malloc and its kin, operator new with them
  long frees = 0;
  long locks = 0;   ///< mutexes, read-write locks, conditions, semaphores
  long prints = 0;  ///< write(), fwrite()
};

/// Counts what the calling thread does between startCounting() and stopCounting(), in the C library
/// itself: a program that links counted_calls.cpp has these functions replaced. One thread at a
/// time.
void startCounting() noexcept;
CallCounts stopCounting() noexcept;

}  // namespace palpate::test
