#pragma once

#include <cstdlib>
#include <random>

namespace palpate::test {

/// Returns whether tests that take minutes are wanted (PALPATE_LONG_TESTS=1, deploy/test
/// --nightly).
inline bool longTestsAreWanted() {
  const char* asked = std::getenv("PALPATE_LONG_TESTS");
  return asked != nullptr && *asked != '\0';
}

/// What random tests begin with: another one each time, but PALPATE_TEST_SEED when it is set, to
/// repeat what failed.
inline unsigned testSeed() {
  const char* asked = std::getenv("PALPATE_TEST_SEED");
  return asked != nullptr ? static_cast<unsigned>(std::strtoul(asked, nullptr, 10))
                          : std::random_device{}();
}

}  // namespace palpate::test
