#pragma once

namespace palpate {

/// Throws std::logic_error: "FILE:LINE: CONDITION does not hold: WHY". Only PALPATE_ASSERT calls
/// it.
[[noreturn]] void assertionFailed(const char* condition, const char* why, const char* file,
                                  int line);

}  // namespace palpate

/// States what must hold where one module hands over to the next, and why, in release builds too.
/// For what only a bug can break: wrong input and failing systems are Errors (error.hpp). Thrown
/// rather than aborted, so that a service ends with everything on disk and libpalpate returns an
/// error. Not in the haptic tick, nor in the loops of kernels: there it would cost time.
#define PALPATE_ASSERT(condition, why) \
  ((condition) ? static_cast<void>(0)  \
               : ::palpate::assertionFailed(#condition, why, __FILE__, __LINE__))
