#pragma once

#include "common/space/configuration.hpp"

namespace palpate {

/// The energy E(s, p) of a finger near one of its equilibria, as the Taylor polynomial that the
/// equilibrium's derivatives give: complete to the second order in the place s and the displacement
/// p, and to the third but for d3E/ds3. Force and drive are exact derivatives of this polynomial,
/// so their work around a closed loop is zero.
struct Expansion {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();         ///< s of the equilibrium, metres
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< p of the equilibrium, metres
  Equilibrium equilibrium;

  struct Sample {
    double energy = 0;                                ///< J
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, -dE/dp
    Eigen::Vector3d drive = Eigen::Vector3d::Zero();  ///< N, -dE/ds
    /// N, magnitude of the third-order terms of the force: what the expansion would be wrong by if
    /// it ended at the second order.
    double last_terms = 0;
  };
  /// Evaluates the polynomial at s and p, metres. Real time.
  Sample at(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;
};

}  // namespace palpate
