#pragma once

namespace palpate::test {

/// Calls of malloc, calloc, realloc and the aligned functions in this process so far, by any
/// library and thread. Negative if they cannot be counted, because a sanitizer has its own
/// allocator.
long allocationCount();

/// While this object exists, all allocations of this thread fail except the first `granted`.
class MemoryShortage {
 public:
  explicit MemoryShortage(long granted);
  ~MemoryShortage();
  MemoryShortage(const MemoryShortage&) = delete;
  MemoryShortage& operator=(const MemoryShortage&) = delete;
};

}  // namespace palpate::test
