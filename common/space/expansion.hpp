#pragma once

#include "common/space/configuration.hpp"

namespace palpate {

/// Taylor polynomial of a finger's energy E(s, p) at one of its equilibria. It is complete to
/// second order in the place s and the displacement p, and to third order except for d3E/ds3. Force
/// and drive are exact derivatives of this polynomial, so their work around a closed loop is zero.
struct Expansion {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();         ///< s of the equilibrium, metres
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< p of the equilibrium, metres
  Equilibrium equilibrium;

  struct Sample {
    double energy = 0;                                ///< J
    Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, -dE/dp
    Eigen::Vector3d drive = Eigen::Vector3d::Zero();  ///< N, -dE/ds
    /// N, magnitude of the force that the third-order terms contribute. It estimates the error that
    /// the force would have without these terms.
    double last_terms = 0;
  };
  /// Evaluates the polynomial at s and p, metres. Real time.
  Sample at(const Eigen::Vector3d& s, const Eigen::Vector3d& p) const noexcept;
};

}  // namespace palpate
