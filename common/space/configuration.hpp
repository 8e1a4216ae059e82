#pragma once

#include <Eigen/Core>
#include <array>
#include <variant>
#include <vector>

#include "common/base/bytes32.hpp"
#include "common/space/failure.hpp"

namespace palpate {

/// The nodal fields of a configuration, in float32, as in files and messages. Transitions start
/// from these rounded values.
struct NodalFields {
  std::vector<float> displacement;  ///< nNodes x 3, one row per node, metres
  /// One pressure per slot of Problem::pressures, Pa; empty without a pressure space.
  std::vector<float> pressure;

  /// Returns the displacement bytes, then the pressure bytes, little-endian.
  std::string encode() const;
  /// Decodes the bytes of encode() for a mesh with `n_nodes` nodes and `n_pressures` pressures.
  /// Error if the size does not match or a value is not finite.
  static NodalFields decode(std::string_view bytes, std::size_t n_nodes, std::size_t n_pressures);
  /// Returns ContentId::of(encode()).
  ContentId id() const;
};

/// Row and column of each of the six independent components of a symmetric 3x3 matrix.
inline constexpr std::array<std::array<int, 2>, 6> symmetric_axes = {
    {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

/// Returns the symmetric matrix with these components, in the order of symmetric_axes.
inline Eigen::Matrix3d symmetricOf(const Eigen::Matrix<double, 6, 1>& c) {
  Eigen::Matrix3d matrix;
  matrix << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return matrix;
}

/// Derivative of a symmetric 3x3 matrix with respect to a vector: one row per component
/// (symmetric_axes), one column per axis of the vector.
using SymmetricSlope = Eigen::Matrix<double, 6, 3, Eigen::RowMajor>;

/// Force, stiffness and energy of an accepted configuration, for every kind of tool.
struct ToolEquilibrium {
  /// Force of the tissue on the tool, N, = -dE/dp.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  /// Stiffness, N/m, [a, b] = d force_a / d p_b: symmetric, negative definite near rest.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  double energy = 0;     ///< J, stored energy relative to the rest state
  double min_det_F = 1;  ///< smallest det F over the elements
};

/// Further derivatives of a finger's energy E(s, p), with s the place of the finger on the surface
/// (ActivePatch::finger) and p its displacement. Zero for other tools. Derivatives with respect to
/// s have three components, because E is defined for any s near the surface. First and second
/// derivatives are exact.
struct FingerSlopes {
  /// Configurational force T = -dE/ds, N, which drives the finger along the surface.
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();
  /// N/m, [a, b] = d drive_a / d p_b. The transpose of this matrix is d force / d s.
  Eigen::Matrix3d drive_stiffness = Eigen::Matrix3d::Zero();
  /// N/m, [a, b] = d drive_a / d s_b, symmetric.
  Eigen::Matrix3d drive_slope = Eigen::Matrix3d::Zero();
  // The third derivatives have about seven correct digits. They have no meaning where the stiffness
  // jumps (worker/solver/third_derivatives.hpp).
  /// N/m^2, d stiffness / d p, symmetric in all three axes.
  SymmetricSlope stiffness_by_p = SymmetricSlope::Zero();
  /// N/m^2, d stiffness / d s. Column k is also the second derivative of drive[k] with respect to
  /// p.
  SymmetricSlope stiffness_by_s = SymmetricSlope::Zero();
  /// N/m^2, d drive_slope / d p.
  SymmetricSlope drive_slope_by_p = SymmetricSlope::Zero();
};

/// Force, energy and their derivatives in a configuration.
struct Equilibrium : ToolEquilibrium, FingerSlopes {};

/// Largest allowed magnitude of a stored number, SI units. No tissue reaches it, and values
/// interpolated from such numbers do not overflow.
inline constexpr double largest_stored = 1e30;
/// Returns whether every number is finite and at most largest_stored in magnitude.
bool isUsable(const Equilibrium& equilibrium);

/// Returns whether any of the derivatives in FingerSlopes is non-zero. True only for fingers.
inline bool hasDrive(const FingerSlopes& e) {
  return !(e.drive.isZero(0) && e.drive_stiffness.isZero(0) && e.drive_slope.isZero(0) &&
           e.stiffness_by_p.isZero(0) && e.stiffness_by_s.isZero(0) &&
           e.drive_slope_by_p.isZero(0));
}

/// Work of the solver to compute an outcome. Every number but `seconds` is reproducible.
struct Cost {
  std::int32_t newton_iterations = 0;
  std::int32_t factorizations = 0;
  std::int32_t steps = 0;  ///< accepted continuation steps
  double seconds = 0;      ///< processor time of the worker; never part of a dataset

  Cost& operator+=(const Cost& other) {
    newton_iterations += other.newton_iterations;
    factorizations += other.factorizations;
    steps += other.steps;
    seconds += other.seconds;
    return *this;
  }
};

/// An accepted equilibrium with its nodal fields, as it is stored.
struct Configuration {
  Equilibrium equilibrium;
  double residual = 0;  ///< N, norm of the residual
  NodalFields fields;
};

/// The result of a transition (a configuration or a failure) and its cost.
struct Outcome {
  std::variant<Failure, Configuration> end;
  Cost cost;

  bool converged() const { return std::holds_alternative<Configuration>(end); }
  /// Valid if converged().
  const Configuration& configuration() const { return std::get<Configuration>(end); }
  Configuration& configuration() { return std::get<Configuration>(end); }
  const Equilibrium& equilibrium() const { return configuration().equilibrium; }
  /// Valid if not converged().
  const Failure& failure() const { return std::get<Failure>(end); }
  Failure& failure() { return std::get<Failure>(end); }
};

}  // namespace palpate
