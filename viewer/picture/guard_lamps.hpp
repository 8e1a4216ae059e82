#pragma once

#include <array>
#include <cstdint>

#include "viewer/haptics/force_guard.hpp"

namespace palpate {

/// Text for the user about a bit of Guarded.
struct LampText {
  const char* words;  ///< one to three: why the felt force differs from that of the tissue
  const char* sentence;
};
/// Indexed by the number of the bit.
inline constexpr std::array<LampText, guard_count> lamp_texts = {
    {{"fading in", "The force has made a step, which is being faded in."},
     {"damping", "The loop has created energy, which is being damped."},
     {"force limited", "The tissue pushes harder than the device can render."},
     {"rate limited", "The force changes faster than the limit of the device."},
     {"no new position",
      "The device has sent no new position for a while: the force goes to zero."},
     {"device lost", "The device is unplugged or does not answer."},
     {"invalid reading", "The position or the force was not finite: the force goes to zero."},
     {"computer too slow", "The loop was delayed; the force restarts from zero."},
     {"deeper than computed",
      "Nothing was computed this deep: a wall, not the tissue, pushes back."}}};

/// One lamp per Guarded bit. A guard often acts for a single tick, which is too short to be seen,
/// so its lamp stays lit for another half second. One thread.
class GuardLamps {
 public:
  static constexpr double hold = 0.5;  ///< s

  /// now: s, of any clock that does not go back. active: Guarded bits of the last tick. ticks:
  /// number of ticks with each bit (LoopStatistics::guards); a lamp is also lit if its number has
  /// grown, because a guard may act between two frames.
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
