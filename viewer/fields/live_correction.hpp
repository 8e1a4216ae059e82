#pragma once

#include <array>

#include "common/space/expansion.hpp"
#include "viewer/fields/area_field.hpp"

namespace palpate {

/// Corrects samples of an area's energy by equilibria that a follower has solved around the hand
/// (worker/solver/follower.hpp). The energies of the last two are blended by a partition of unity,
///
///   E(s, p) = (b E_area(s, p) + sum of w_n E_n(s, p)) / (b + sum of w_n),
///
/// where E_n are expansions of the third order, the weights w_n fall steeply with the distance of
/// (s, p) from the expansion and end at its reach, and b is a small constant. So near an expansion
/// the follower's energy counts, and far from both the area's. When an expansion is added, the
/// blend fades over to the new pair. Force and drive are the gradient of one energy as long as the
/// expansions and the fade stay the same.
///
/// One thread, real time: nothing allocates, locks, throws or logs.
class LiveCorrection {
 public:
  /// Duration of the fade to the area alone, s.
  static constexpr double release_time = 0.03;

  /// `finger_radius`: m.
  explicit LiveCorrection(double finger_radius);

  /// Begins to fade over to this expansion and the one before, within `seconds`, 0 or more. If a
  /// fade is in progress, it goes on toward the new pair.
  void add(const Expansion& expansion, double seconds) noexcept;
  /// Lets `seconds` of the fade pass.
  void advance(double seconds) noexcept;
  /// Begins to fade over to the area alone.
  void release() noexcept;

  /// Replaces `sample`, the area's at (s, p), by the corrected one. s: m, place of the finger; p:
  /// m, displacement. Returns the share of the expansions, 0 to 1. The error bound contains the
  /// disagreement of the expansions and the size of their last terms.
  double correct(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                 AreaSample& sample) const noexcept;

 private:
  struct Pair {
    std::array<Expansion, 2> expansions;  ///< the newest first
    std::size_t size = 0;
  };
  struct Weight {
    double value = 0, distance = 0;                  ///< distance: 0 to 1, in reaches
    Eigen::Vector3d by_s = Eigen::Vector3d::Zero();  ///< 1/m
    Eigen::Vector3d by_p = Eigen::Vector3d::Zero();  ///< 1/m
  };
  Weight weightOf(const Expansion& expansion, const Eigen::Vector3d& s,
                  const Eigen::Vector3d& p) const noexcept;
  double blend(const Pair& pair, const Eigen::Vector3d& s, const Eigen::Vector3d& p,
               AreaSample& sample) const noexcept;

  const double reach_;  ///< m
  Pair before_, now_;
  double level_ = 1;  ///< of the fade from before_ to now_
  double rate_ = 0;   ///< 1/s
};

}  // namespace palpate
