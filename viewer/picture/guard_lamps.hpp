#pragma once

#include <array>
#include <cstdint>

#include "viewer/haptics/force_guard.hpp"

namespace palpate {

/// One lamp per Guarded bit. A guard often acts for a single tick, which no eye would see: a lamp
/// stays lit for half a second after. One thread.
class GuardLamps {
 public:
  static constexpr double hold = 0.5;  ///< s

  /// now: s, of any clock that does not go back. active: Guarded bits. ticks: how often each acted
  /// so far (LoopStatistics::guards): one that acted between two pictures is noticed too.
  void update(double now, std::uint32_t active,
              const std::array<std::uint64_t, guard_count>& ticks) {
    for (int bit = 0; bit < guard_count; ++bit) {
      const auto n = static_cast<std::size_t>(bit);
      if (((active >> bit) & 1U) != 0 || ticks[n] > seen_[n]) until_[n] = now + hold;
      seen_[n] = ticks[n];
    }
    now_ = now;
  }
  bool lit(int bit) const { return until_[static_cast<std::size_t>(bit)] > now_; }

 private:
  std::array<double, guard_count> until_ = {};
  std::array<std::uint64_t, guard_count> seen_ = {};
  double now_ = 0;
};

}  // namespace palpate
