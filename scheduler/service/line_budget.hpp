#pragma once

#include <chrono>
#include <cstdint>
#include <utility>

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

  /// Whether a line fits; it is counted as told, or as left out.
  bool spend(Time now);
  /// Since the last takeLeftOut().
  std::int64_t leftOut() const { return left_out_; }
  std::int64_t takeLeftOut() { return std::exchange(left_out_, 0); }

 private:
  Time filled_;  ///< up to when lines were given
  std::int64_t lines_ = burst;
  std::int64_t left_out_ = 0;
};

}  // namespace palpate
