#pragma once

#include <array>
#include <limits>

#include "common/space/expansion.hpp"
#include "viewer/fields/area_field.hpp"

namespace palpate {

/// Force of the tissue on a hold, N, and an upper estimate of its error. NaN if they are not known.
struct HoldForce {
  Eigen::Vector3d force = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  double error_bound = std::numeric_limits<double>::quiet_NaN();
};

/// Corrects samples of an area's energy by equilibria that the live solver found near the hand
/// (worker/solver/follower.hpp). The last two equilibria are blended with the area by a partition
/// of unity,
///
///   E(s, p) = (b E_area(s, p) + sum of w_n E_n(s, p)) / (b + sum of w_n),
///
/// where E_n is the third-order expansion of the energy at equilibrium n. The weight w_n falls
/// steeply with the distance of (s, p) from that equilibrium and is zero beyond its reach; b is a
/// small constant. So E follows the live solver near an equilibrium, and the area far from both
/// equilibria. When an expansion is added, the blend fades to the new pair. While neither the
/// expansions nor the fade change, force and drive are the negative gradient of one energy.
///
/// A second finger may hold the body. The expansions depend on its place and displacement too. The
/// area does not, so while there is a hold, its error bound counts as at least the magnitude of its
/// force.
///
/// One thread. Real time: does not allocate, lock, throw or log.
class LiveCorrection {
 public:
  /// Duration of the fade to the area alone, s.
  static constexpr double release_time = 0.03;

  /// `finger_radius`: m. has_fibers: SpaceTable::has_fibers. The stiffness of fibres jumps where
  /// they become taut, which no expansion foresees.
  explicit LiveCorrection(double finger_radius, bool has_fibers = false);

  /// Begins to fade to the pair of this expansion and the previous one, within `seconds`, 0 or
  /// more. A fade in progress continues at its rate, toward the new pair.
  void add(const Expansion& expansion, double seconds) noexcept;
  /// Sets the hold, or none. One that begins, ends, or jumps by over a quarter of the finger's
  /// radius is another one: until an expansion for it is added, the old ones are used as if their
  /// hold had not moved, and the error bound is at least the magnitude of the force.
  void setHold(const std::optional<Hold>& hold) noexcept;
  /// Returns whether an expansion is for the hold, or for none if there is none.
  bool isForHold(const Expansion& expansion) const noexcept;
  void advance(double seconds) noexcept;
  /// Begins to fade to the area alone, within `seconds`.
  void release(double seconds = release_time) noexcept;

  /// Corrects `sample`, which must be the area's sample at (s, p). s: m, place of the finger; p: m,
  /// displacement. Returns the share of the expansions, 0 to 1. The error bound includes the
  /// disagreement of the expansions, the size of their last terms, and during a fade the difference
  /// of both sides. `inside` is false where the bound is as large as the force, and more than
  /// 20 mN.
  double correct(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                 AreaSample& sample) const noexcept;

  /// Returns the force on the hold; NaN if no expansion near (s, p) has it.
  HoldForce holdForce(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;

 private:
  struct Pair {
    std::array<Expansion, 2> expansions;  ///< the newest first
    std::size_t size = 0;
    bool is_for_hold = false;  ///< whether both are for hold_
  };
  struct Weight {
    double value = 0, distance = 0;                  ///< distance: 0 to 1, in reaches
    Eigen::Vector3d by_s = Eigen::Vector3d::Zero();  ///< 1/m
    Eigen::Vector3d by_p = Eigen::Vector3d::Zero();  ///< 1/m
  };
  Weight weightOf(const Expansion& expansion, const Eigen::Vector3d& s, const Eigen::Vector3d& p,
                  const std::optional<Hold>& hold) const noexcept;
  double blend(const Pair& pair, const Eigen::Vector3d& s, const Eigen::Vector3d& p,
               AreaSample& sample) const noexcept;

  const double reach_;      ///< m
  const double own_error_;  ///< relative error of an expansion's force at its equilibrium
  Pair before_, now_;
  std::optional<Hold> hold_;
  double level_ = 1;  ///< progress of the fade from before_ to now_, 0 to 1
  double rate_ = 0;   ///< 1/s
};

}  // namespace palpate
