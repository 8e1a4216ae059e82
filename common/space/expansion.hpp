#pragma once

#include <optional>

#include "common/space/configuration.hpp"

namespace palpate {

/// A second finger, which holds the body: it stays at one place of the surface.
struct Hold {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();         ///< m
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
};

/// Derivatives of a finger's energy E(s, p) with respect to the displacement h of a hold.
struct Held {
  Hold at;                                          ///< the hold in the equilibrium
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< N, -dE/dh, of the tissue on the hold
  /// N/m, [a, b] = d force_a / d h_b, symmetric
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  /// N/m, [a, b] = d force_a / d h_b and d drive_a / d h_b, of the moving finger. The transposes
  /// are the derivatives of the hold's force with respect to p and s.
  Eigen::Matrix3d force_by_hold = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d drive_by_hold = Eigen::Matrix3d::Zero();
};

/// Taylor polynomial of a finger's energy E(s, p) at one of its equilibria. It is complete to
/// second order in the place s and the displacement p, and to third order except for d3E/ds3. Force
/// and drive are exact derivatives of this polynomial, so their work around a closed loop is zero.
/// With a hold, the energy also depends on its displacement, to second order.
struct Expansion {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();         ///< s of the equilibrium, metres
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< p of the equilibrium, metres
  Equilibrium equilibrium;
  std::optional<Held> held = {};  ///< if a second finger holds the body

  struct Sample {
    double energy = 0;                                     ///< J
    Eigen::Vector3d force = Eigen::Vector3d::Zero();       ///< N, -dE/dp
    Eigen::Vector3d drive = Eigen::Vector3d::Zero();       ///< N, -dE/ds
    Eigen::Vector3d hold_force = Eigen::Vector3d::Zero();  ///< N, on the hold, if both are given
    /// N, magnitude of the force that the highest terms contribute: those of third order, or of
    /// second order without the former, and those of the hold's motion. It estimates the error that
    /// the force would have without these terms.
    double last_terms = 0;
    double hold_last_terms = 0;  ///< N, likewise for hold_force, whose highest terms are the first
  };
  /// Evaluates the polynomial at s and p, metres, with the hold, if there is one, at the
  /// displacement of `hold`. Real time.
  Sample at(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
            const std::optional<Hold>& hold = {}) const noexcept;
  /// Sets the third derivatives to zero if they would double the stiffness within `distance`,
  /// metres: where a fibre becomes taut, they are its jump divided by a tiny step. Real time.
  void dropMeaningless(double distance) noexcept;
};

}  // namespace palpate
