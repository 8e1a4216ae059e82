#include "tests/viewer/haptics/counted_calls.hpp"

#include <dlfcn.h>
#include <pthread.h>
#include <semaphore.h>
#include <stdio.h>
#include <sys/types.h>

#include <cerrno>
#include <cstddef>

extern "C" {
// The real allocator, under the names that the C library provides for replacements of malloc.
// NOLINTBEGIN(readability-identifier-naming)
void* __libc_malloc(size_t size);
void* __libc_calloc(size_t count, size_t size);
void* __libc_realloc(void* memory, size_t size);
void* __libc_memalign(size_t alignment, size_t size);
void __libc_free(void* memory);
// NOLINTEND(readability-identifier-naming)
}

namespace palpate::test {
namespace {

thread_local bool counting = false;
thread_local CallCounts counts;

void add(long CallCounts::*kind) noexcept {
  if (counting) ++(counts.*kind);
}

/// The C library's function of this name.
template <class Function>
Function next(const char* name) noexcept {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

void startCounting() noexcept {
  counts = {};
  counting = true;
}

CallCounts stopCounting() noexcept {
  counting = false;
  return counts;
}

}  // namespace palpate::test

using palpate::test::add;
using palpate::test::CallCounts;
using palpate::test::next;

extern "C" {

void* malloc(size_t size) {
  add(&CallCounts::allocations);
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) {
  add(&CallCounts::allocations);
  return __libc_calloc(count, size);
}
void* realloc(void* memory, size_t size) {
  add(&CallCounts::allocations);
  return __libc_realloc(memory, size);
}
void* memalign(size_t alignment, size_t size) {
  add(&CallCounts::allocations);
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  add(&CallCounts::allocations);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, size_t alignment, size_t size) {
  add(&CallCounts::allocations);
  *memory = __libc_memalign(alignment, size);
  return *memory != nullptr ? 0 : ENOMEM;
}
void free(void* memory) {
  if (memory != nullptr) add(&CallCounts::frees);
  __libc_free(memory);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static const auto lock = next<int (*)(pthread_mutex_t*)>("pthread_mutex_lock");
  add(&CallCounts::locks);
  return lock(mutex);
}
int pthread_mutex_trylock(pthread_mutex_t* mutex) {
  static const auto lock = next<int (*)(pthread_mutex_t*)>("pthread_mutex_trylock");
  add(&CallCounts::locks);
  return lock(mutex);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* mutex) {
  static const auto lock = next<int (*)(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
  add(&CallCounts::locks);
  return lock(mutex);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* mutex) {
  static const auto lock = next<int (*)(pthread_rwlock_t*)>("pthread_rwlock_wrlock");
  add(&CallCounts::locks);
  return lock(mutex);
}
int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static const auto wait = next<int (*)(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
  add(&CallCounts::locks);
  return wait(condition, mutex);
}
int sem_wait(sem_t* semaphore) {
  static const auto wait = next<int (*)(sem_t*)>("sem_wait");
  add(&CallCounts::locks);
  return wait(semaphore);
}

ssize_t write(int file, const void* bytes, size_t size) {
  static const auto put = next<ssize_t (*)(int, const void*, size_t)>("write");
  add(&CallCounts::prints);
  return put(file, bytes, size);
}
size_t fwrite(const void* bytes, size_t size, size_t count, FILE* file) {
  static const auto put = next<size_t (*)(const void*, size_t, size_t, FILE*)>("fwrite");
  add(&CallCounts::prints);
  return put(bytes, size, count, file);
}
}
