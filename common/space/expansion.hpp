#pragma once

#include <optional>

#include "common/space/configuration.hpp"

namespace palpate {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

/// A second finger, which holds the body and can slide over its surface.
struct Hold {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();         ///< m, on the surface at rest
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< m
};

/// Derivatives of a finger's energy E(s, p) with respect to the displacement h and the place t of a
/// hold. Vectors and matrices have three rows or columns for displacements, then three for places.
struct Held {
  Hold at;  ///< the hold in the equilibrium
  /// N, -dE/dh, the force of the tissue on the hold, and -dE/dt, which drives it along the surface.
  Vector6d force = Vector6d::Zero();
  /// N/m, [a, b] = d force_a / d (h, t)_b, symmetric
  Matrix6d stiffness = Matrix6d::Zero();
  /// N/m, [a, b] = derivatives of the force and the drive of the moving finger with respect to
  /// (h, t)_b. The transpose is the derivative of the hold's force with respect to (p, s).
  Matrix6d hand_by_hold = Matrix6d::Zero();
};

/// Taylor polynomial of a finger's energy E(s, p) at one of its equilibria. It is complete to
/// second order in the place s and the displacement p, and to third order except for d3E/ds3. Force
/// and drive are exact derivatives of this polynomial, so their work around a closed loop is zero.
/// With a hold, the energy also depends on its displacement and place, to second order.
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
  /// Evaluates the polynomial at s and p, metres, with the hold, if both are given, at `hold`. Real
  /// time.
  Sample at(const Eigen::Vector3d& s, const Eigen::Vector3d& p,
            const std::optional<Hold>& hold = {}) const noexcept;
  /// Sets the third derivatives to zero if they would double the stiffness within `distance`,
  /// metres: where a fibre becomes taut, they are its jump divided by a tiny step. Real time.
  void dropMeaningless(double distance) noexcept;
};

}  // namespace palpate
