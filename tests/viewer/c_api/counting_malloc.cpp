#include "tests/viewer/c_api/counting_malloc.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

// Definitions in the program replace those of the C library for all loaded libraries.

namespace {
std::atomic<long> allocations = 0;
constexpr long unlimited = -1;
// In the program's own thread-local storage, which needs no allocation.
thread_local long granted_to_thread = unlimited;

/// Counts an allocation. Returns whether it is granted.
[[maybe_unused]] bool grant() {
  ++allocations;
  if (granted_to_thread == unlimited) return true;
  if (granted_to_thread == 0) return false;
  --granted_to_thread;
  return true;
}

}  // namespace

namespace palpate::test {

MemoryShortage::MemoryShortage(long granted) { granted_to_thread = granted; }
MemoryShortage::~MemoryShortage() { granted_to_thread = unlimited; }

}  // namespace palpate::test

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

long palpate::test::allocationCount() { return -1; }

#else

long palpate::test::allocationCount() { return allocations; }

extern "C" {
void* __libc_malloc(std::size_t size);                           // NOLINT: glibc's names
void* __libc_calloc(std::size_t count, std::size_t size);        // NOLINT
void* __libc_realloc(void* memory, std::size_t size);            // NOLINT
void* __libc_memalign(std::size_t alignment, std::size_t size);  // NOLINT

void* malloc(std::size_t size) noexcept { return grant() ? __libc_malloc(size) : nullptr; }
void* calloc(std::size_t count, std::size_t size) noexcept {
  return grant() ? __libc_calloc(count, size) : nullptr;
}
void* realloc(void* memory, std::size_t size) noexcept {
  return grant() ? __libc_realloc(memory, size) : nullptr;
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  return grant() ? __libc_memalign(alignment, size) : nullptr;
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  *memory = memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}
}

#endif
