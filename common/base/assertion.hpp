#pragma once

namespace palpate {

/// Throws std::logic_error "FILE:LINE: CONDITION does not hold: WHY". For PALPATE_ASSERT only.
[[noreturn]] void assertionFailed(const char* condition, const char* why, const char* file,
                                  int line);

}  // namespace palpate

/// Checks a condition that must hold where one module hands over to another, and says why, in
/// release builds too. Only a bug may break it: wrong input and failing systems are Errors
/// (error.hpp). It throws instead of aborting, so that a service ends with everything on disk and
/// libpalpate returns an error. It costs time, so it is not used in the haptic tick or in inner
/// loops of kernels.
#define PALPATE_ASSERT(condition, why) \
  ((condition) ? static_cast<void>(0)  \
               : ::palpate::assertionFailed(#condition, why, __FILE__, __LINE__))
