#pragma once

#include <array>
#include <vector>

#include "viewer/cell_grid.hpp"
#include "viewer/force_field.hpp"

namespace palpate {

/// Interpolates the stored energy E(p) and differentiates it: force = -grad E, stiffness = -Hessian.
/// Therefore conservative by construction (a closed loop returns no energy), with a symmetric stiffness.
///
/// In a cell E is the tensor product quintic Hermite polynomial of the 27 derivatives d^(a+b+c) E / dx^a dy^b
/// dz^c, a, b, c <= 2, at its 8 corners. They are values of lattice points, the same for every cell around: E
/// has continuous second derivatives, so force and stiffness are continuous over faces.
///   orders 0 to 2  exact: energy, -force, -stiffness
///   E_xxy and alike  from E_y and E_xy of the neighbours along x (compact difference, error spacing^4;
///   spacing^2 with one neighbour) E_xyz  from the mixed second derivatives of the neighbours (error
///   spacing^2; spacing with one neighbour) E_xxyy, E_xxyz and alike  second differences of second
///   derivatives, zero where a neighbour is missing higher ones  zero
/// A direction without neighbours contributes zero. So energies up to the fourth degree are exact where all
/// neighbours are solved, up to the third everywhere that has one along each axis, and the error of the force
/// goes with spacing^4 (spacing^3 next to missing points).
class PotentialField : public ForceField {
 public:
  explicit PotentialField(const SpaceTable& space);
  ForceSample evaluate(const Eigen::Vector3d& displacement) const noexcept override;
  std::string_view name() const override { return "potential"; }

  /// One lattice point: derivative (a, b, c) times spacing^(a+b+c), J, at [a + 3 b + 9 c].
  using Derivatives = std::array<double, 27>;

 private:
  CellGrid grid_;
  std::vector<Equilibrium> points_;            ///< per lattice point
  std::vector<Eigen::Vector3d> displacement_;  ///< per lattice point, metres
  std::vector<Derivatives> derivatives_;       ///< per lattice point; zero when not solved
};

}  // namespace palpate
