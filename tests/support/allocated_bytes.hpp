#pragma once

#include <malloc.h>

#include <cstddef>
#include <optional>

namespace palpate::test {

/// What this process has of malloc and has not given back; nothing under a sanitizer, which has a
/// malloc of its own.
inline std::optional<std::size_t> allocatedBytes() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return std::nullopt;
#else
  const struct mallinfo2 all = mallinfo2();
  return all.uordblks + all.hblkhd;  // large pieces are mapped
#endif
}

}  // namespace palpate::test
