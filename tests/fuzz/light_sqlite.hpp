#pragma once

#include <sqlite3.h>

#include <cstdint>

#include "tests/fuzz/fuzzer.hpp"

// The functions of glibc, which sanitizers do not replace.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void __libc_free(void* memory);
}

namespace palpate::fuzz {

/// Call this before the first use of SQLite. It disables SQLite's locks and statistics, and hides
/// its memory from the address sanitizer: SQLite is not under test, and allocates thousands of
/// small blocks for every input.
inline void makeSqliteLight() {
  constexpr std::ptrdiff_t head = 16;  // bytes before each block, which store its size
  static const auto sizeOf = [](void* piece) -> int& {
    return *reinterpret_cast<int*>(static_cast<char*>(piece) - head);
  };
  static const auto behindHead = [](void* memory, int size) -> void* {
    if (memory == nullptr) return nullptr;
    void* const piece = static_cast<char*>(memory) + head;
    sizeOf(piece) = size;
    return piece;
  };
  static const sqlite3_mem_methods methods = {
      .xMalloc =
          [](int size) {
            return behindHead(__libc_malloc(static_cast<std::size_t>(head + size)), size);
          },
      .xFree = [](void* piece) { __libc_free(static_cast<char*>(piece) - head); },
      .xRealloc =
          [](void* piece, int size) {
            return behindHead(__libc_realloc(static_cast<char*>(piece) - head,
                                             static_cast<std::size_t>(head + size)),
                              size);
          },
      .xSize = [](void* piece) { return piece == nullptr ? 0 : sizeOf(piece); },
      .xRoundup = [](int size) { return (size + 7) & ~7; },
      .xInit = [](void*) { return SQLITE_OK; },
      .xShutdown = [](void*) {},
      .pAppData = nullptr};
  require(sqlite3_config(SQLITE_CONFIG_MALLOC, &methods) == SQLITE_OK &&
              sqlite3_config(SQLITE_CONFIG_SINGLETHREAD) == SQLITE_OK &&
              sqlite3_config(SQLITE_CONFIG_MEMSTATUS, 0) == SQLITE_OK,
          "SQLite was used before");
}

}  // namespace palpate::fuzz
