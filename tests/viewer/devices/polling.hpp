#pragma once

#include <chrono>
#include <thread>

namespace palpate::test {

/// Checks every millisecond until `condition` holds. False after a generous limit, which only
/// guards against hanging.
template <class Condition>
bool eventually(Condition condition, std::chrono::seconds limit = std::chrono::seconds(20)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace palpate::test
