#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "viewer/c_api/last_error.hpp"

namespace palpate {

// Checks of arguments. Each tells whether the argument can be used, and records what is wrong with
// it.

inline bool isThere(const char* function, const char* name, const void* pointer) noexcept {
  if (pointer == nullptr) invalid("{}: {} is NULL", function, name);
  return pointer != nullptr;
}

inline bool isNumber(const char* function, const char* what, std::int32_t number,
                     std::int32_t count) noexcept {
  if (number >= 0 && number < count) return true;
  invalid("{}: there is no {} {}; they are numbered 0 to {}", function, what, number, count - 1);
  return false;
}

inline bool isEnough(const char* function, std::size_t capacity, std::size_t needed) noexcept {
  if (capacity >= needed) return true;
  invalid("{}: the buffer holds {} numbers, {} are needed", function, capacity, needed);
  return false;
}

inline bool isPositive(const char* function, const char* name, double value) noexcept {
  if (value > 0 && std::isfinite(value)) return true;
  invalid("{}: {} is {}; it must be finite and > 0", function, name, value);
  return false;
}

inline bool isAtLeastZero(const char* function, const char* name, double value) noexcept {
  if (value >= 0 && std::isfinite(value)) return true;
  invalid("{}: {} is {}; it must be finite and >= 0", function, name, value);
  return false;
}

/// Numbers in `triples` vertices or triangles.
inline std::size_t countOf(std::int32_t triples) noexcept {
  return 3 * static_cast<std::size_t>(triples);
}

}  // namespace palpate
