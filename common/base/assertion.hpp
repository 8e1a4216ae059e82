#pragma once

namespace palpate {

/// Throws std::logic_error "FILE:LINE: CONDITION does not hold: WHY". For PALPATE_ASSERT only.
[[noreturn]] void assertionFailed(const char* condition, const char* why, const char* file,
                                  int line);

}  // namespace palpate

/// Checks a condition that one module relies on and another guarantees; `why` states the broken
/// rule. Active in release builds too. Only a bug can break such a condition: wrong input and
/// failures of the system are reported as Errors (error.hpp). A broken condition throws instead of
/// aborting, so that a service can still write everything to disk and libpalpate can return an
/// error. The check costs time, so do not use it in the haptic tick or in inner loops of kernels.
#define PALPATE_ASSERT(condition, why) \
  ((condition) ? static_cast<void>(0)  \
               : ::palpate::assertionFailed(#condition, why, __FILE__, __LINE__))
