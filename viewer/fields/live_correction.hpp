#pragma once

#include <array>

#include "common/space/expansion.hpp"
#include "viewer/fields/area_field.hpp"

namespace palpate {

/// Corrects samples of an area's energy by equilibria that a follower has solved around the hand
/// (worker/solver/follower.hpp). The energies are blended by a partition of unity,
///
///   E(s, p) = (b E_area(s, p) + sum of w_n E_n(s, p)) / (b + sum of w_n),
///
/// where E_n are expansions of the third order, the weights w_n fall steeply with the distance of
/// (s, p) from the expansion and end at its reach, and b is a small constant. So near an expansion
/// the follower's energy counts, far from all of them the area's, and force and drive are the
/// gradient of one energy as long as the set of expansions is the same.
///
/// Expansions fade in and out, so that a new one does not make the force jump. One thread, real
/// time: nothing allocates, locks, throws or logs.
class LiveCorrection {
 public:
  /// Number of expansions that are blended. A fade lasts about two solves of a follower.
  static constexpr std::size_t most = 6;
  /// Duration of a fade, s.
  static constexpr double fade = 0.03;

  /// `finger_radius`: m.
  explicit LiveCorrection(double finger_radius);

  /// Begins to fade in an expansion. The oldest of those that are not needed fade out; if `most`
  /// are visible, the one with the smallest weight at the new expansion ends at once.
  void add(const Expansion& expansion) noexcept;
  /// Lets `seconds` of fades pass.
  void advance(double seconds) noexcept;
  /// Fades out all expansions.
  void release() noexcept;

  /// Replaces `sample`, the area's at (s, p), by the corrected one. s: m, place of the finger; p:
  /// m, displacement. Returns the follower's share of the result, 0 to 1. The error bound contains
  /// the disagreement of the expansions and the size of their last terms.
  double correct(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                 AreaSample& sample) const noexcept;

 private:
  struct Slot {
    Expansion expansion;
    double level = 0;  ///< 0: not visible, 1: faded in
    bool rises = false;
    std::uint64_t number = 0;  ///< counts the expansions that were added
  };
  struct Weight {
    double value = 0, distance = 0;                  ///< distance: 0 to 1, in reaches
    Eigen::Vector3d by_s = Eigen::Vector3d::Zero();  ///< 1/m
    Eigen::Vector3d by_p = Eigen::Vector3d::Zero();  ///< 1/m
  };
  Weight weightOf(const Slot& slot, const Eigen::Vector3d& s,
                  const Eigen::Vector3d& p) const noexcept;

  const double reach_;  ///< m
  std::array<Slot, most> slots_;
  std::uint64_t count_ = 0;
};

}  // namespace palpate
