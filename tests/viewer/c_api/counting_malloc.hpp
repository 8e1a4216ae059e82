#pragma once

namespace palpate::test {

/// Calls of malloc, calloc, realloc and the aligned kinds in this process so far, by any library
/// and thread. Negative where they cannot be counted (under a sanitizer, which has allocators of
/// its own).
long allocationCount();

/// While it lives, all allocations of this thread fail but the first `granted`.
class MemoryShortage {
 public:
  explicit MemoryShortage(long granted);
  ~MemoryShortage();
  MemoryShortage(const MemoryShortage&) = delete;
  MemoryShortage& operator=(const MemoryShortage&) = delete;
};

}  // namespace palpate::test
