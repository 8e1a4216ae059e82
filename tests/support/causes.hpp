#pragma once

#include <vector>

#include "common/space/failure.hpp"

namespace palpate::test {

/// Every existing cause, including causes that are appended later.
inline std::vector<Cause> allCauses() {
  std::vector<Cause> causes;
  for (std::uint32_t value = 0; value < 1000; ++value)
    if (const auto cause = causeOf(value)) causes.push_back(*cause);
  return causes;
}

}  // namespace palpate::test
