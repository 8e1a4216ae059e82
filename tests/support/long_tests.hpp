#pragma once

#include <cstdlib>
#include <random>

namespace palpate::test {

/// Returns whether tests that take minutes are requested (PALPATE_LONG_TESTS=1, deploy/test
/// --nightly).
inline bool longTestsAreWanted() {
  const char* asked = std::getenv("PALPATE_LONG_TESTS");
  return asked != nullptr && *asked != '\0';
}

/// The seed of random tests. It differs in each run; PALPATE_TEST_SEED repeats a run that failed.
inline unsigned testSeed() {
  const char* asked = std::getenv("PALPATE_TEST_SEED");
  return asked != nullptr ? static_cast<unsigned>(std::strtoul(asked, nullptr, 10))
                          : std::random_device{}();
}

}  // namespace palpate::test
