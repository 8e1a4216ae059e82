#pragma once

#include <array>
#include <cstdint>

#include "viewer/haptics/force_guard.hpp"

namespace palpate {

/// Returns one to three words for the user about bit n of Guarded. They say why the force in the
/// hand differs from the tissue's force.
inline const char* lampWords(int bit) {
  static constexpr std::array<const char*, guard_count> words = {
      "fading in",       "damping",           "force limited",
      "rate limited",    "no new position",   "device lost",
      "invalid reading", "computer too slow", "deeper than computed"};
  return bit >= 0 && bit < guard_count ? words[static_cast<std::size_t>(bit)] : "";
}
/// Returns a sentence for the user about bit n of Guarded.
inline const char* lampSentence(int bit) {
  static constexpr std::array<const char*, guard_count> sentences = {
      "The force has made a step, which is being faded in.",
      "The loop has created energy, which is being damped.",
      "The tissue pushes harder than the device can render.",
      "The force changes faster than the limit of the device.",
      "The device has sent no new position for a while: the force goes to zero.",
      "The device is unplugged or does not answer.",
      "The position or the force was not finite and counts as zero.",
      "The loop was delayed; the force restarts from zero.",
      "Nothing was computed this deep: a wall, not the tissue, pushes back."};
  return bit >= 0 && bit < guard_count ? sentences[static_cast<std::size_t>(bit)] : "";
}

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
