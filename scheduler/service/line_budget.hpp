#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace palpate {

/// How many lines peers may cause. They come and go as often as they like, and the disk must not
/// fill with it. One thread.
class LineBudget {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// A fleet of a thousand workers that starts, and a line a second after that.
  static constexpr std::int64_t burst = 1000;
  static constexpr std::chrono::seconds interval{1};

  explicit LineBudget(Time now) : filled_(now) {}

  /// How many lines were left out since the last one, for which there is room now; nothing: this
  /// one is left out too.
  std::optional<std::int64_t> spend(Time now);

 private:
  Time filled_;  ///< up to when lines were given
  std::int64_t lines_ = burst;
  std::int64_t left_out_ = 0;
};

}  // namespace palpate
