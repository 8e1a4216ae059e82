#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace palpate {

/// Limits the log lines and events that peers cause. Peers can join and leave as often as they
/// like, and the lines about them must not fill the disk. One thread.
class LineBudget {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A thousand workers may start at once; after that, one line per second is allowed.
  static constexpr std::int64_t burst = 1000;
  static constexpr std::chrono::seconds interval{1};

  explicit LineBudget(Time now) : filled_(now) {}

  /// Call before each line. Returns the number of lines that were left out since the last accepted
  /// line. Returns none if this line must be left out too.
  std::optional<std::int64_t> spend(Time now);

 private:
  Time filled_;  ///< lines_ includes the lines allowed up to this time
  std::int64_t lines_ = burst;
  std::int64_t left_out_ = 0;
};

}  // namespace palpate
