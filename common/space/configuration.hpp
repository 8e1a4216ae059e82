#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <variant>
#include <vector>

#include "common/base/bytes32.hpp"
#include "common/space/failure.hpp"

namespace palpate {

/// The bulky part of a configuration: float32, as stored, sent and started from.
struct NodalFields {
  std::vector<float> displacement;  ///< nNodes x 3, row per node, metres
  std::vector<float> pressure;      ///< Problem::pressures, Pa; empty without a pressure space

  /// displacement bytes, then pressure bytes, little-endian.
  std::string encode() const;
  /// Inverse of encode for a mesh of n_nodes, n_pressures of which have a pressure; Error when the
  /// size is another or a value is not finite.
  static NodalFields decode(std::string_view bytes, std::size_t n_nodes, std::size_t n_pressures);
  /// ContentId::of(encode()).
  ContentId id() const;
};

/// The axes of the six components of a symmetric matrix.
inline constexpr std::array<std::array<int, 2>, 6> symmetric_axes = {
    {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}}};

/// How a symmetric matrix changes: a row per component, a column per axis along which it does.
using SymmetricSlope = Eigen::Matrix<double, 6, 3, Eigen::RowMajor>;

/// What every tool's accepted configuration says of force and energy.
struct ToolEquilibrium {
  /// N, exerted by the tissue on the tool, = -dE/dp.
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  /// N/m, [a, b] = d force_a / d p_b: symmetric, negative definite near rest.
  Eigen::Matrix3d stiffness = Eigen::Matrix3d::Zero();
  double energy = 0;     ///< J, stored energy relative to the rest state
  double min_det_F = 1;  ///< smallest over the elements
};

/// What a finger's says beyond that: at s on the surface (ActivePatch::finger) its energy E(s, p)
/// also changes with s. Zero of other tools. All exact, in three dimensions, because E is defined
/// for any s near the surface.
struct FingerSlopes {
  /// N, what drives the finger along, T = -dE/ds.
  Eigen::Vector3d drive = Eigen::Vector3d::Zero();
  /// N/m, [a, b] = d drive_a / d p_b; the transpose is d force / d s.
  Eigen::Matrix3d drive_stiffness = Eigen::Matrix3d::Zero();
  /// N/m, [a, b] = d drive_a / d s_b, symmetric.
  Eigen::Matrix3d drive_slope = Eigen::Matrix3d::Zero();
  // The third derivatives, to some seven digits; where the stiffness jumps they are any number
  // (worker/solver/third_derivatives.hpp).
  /// N/m^2, d stiffness / d p, the same whichever axes change places.
  SymmetricSlope stiffness_by_p = SymmetricSlope::Zero();
  /// N/m^2, d stiffness / d s; its column k is also the second derivative of drive[k] by p.
  SymmetricSlope stiffness_by_s = SymmetricSlope::Zero();
  /// N/m^2, d drive_slope / d p.
  SymmetricSlope drive_slope_by_p = SymmetricSlope::Zero();
};

/// The small part of a configuration.
struct Equilibrium : ToolEquilibrium, FingerSlopes {};

/// In SI units: more than any tissue gives, and far enough from overflow that what is interpolated
/// from such numbers is finite.
inline constexpr double largest_stored = 1e30;
/// Whether every number of it is finite, and at most largest_stored.
bool isUsable(const Equilibrium& equilibrium);

/// Whether it says anything of how the energy changes with s: a finger's.
inline bool hasDrive(const FingerSlopes& e) {
  return !(e.drive.isZero(0) && e.drive_stiffness.isZero(0) && e.drive_slope.isZero(0) &&
           e.stiffness_by_p.isZero(0) && e.stiffness_by_s.isZero(0) &&
           e.drive_slope_by_p.isZero(0));
}

/// How much work an answer took. Everything but `seconds` is reproducible.
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

/// An equilibrium, as it is stored.
struct Configuration {
  Equilibrium equilibrium;
  double residual = 0;  ///< N, norm
  NodalFields fields;
};

/// The end of a transition, and what it took.
struct Outcome {
  std::variant<Failure, Configuration> end;
  Cost cost;

  bool converged() const { return std::holds_alternative<Configuration>(end); }
  /// Where it converged.
  const Configuration& configuration() const { return std::get<Configuration>(end); }
  Configuration& configuration() { return std::get<Configuration>(end); }
  const Equilibrium& equilibrium() const { return configuration().equilibrium; }
  /// Where it did not.
  const Failure& failure() const { return std::get<Failure>(end); }
  Failure& failure() { return std::get<Failure>(end); }
};

}  // namespace palpate
