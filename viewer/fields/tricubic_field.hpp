#pragma once

#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// The paper's tri-cubic method (Lekien and Marsden 2005). In a leaf, each force component h is a
/// tensor product cubic Hermite polynomial. Its data are the eight derivatives d^(a+b+c) h / dx^a
/// dy^b dz^c, a, b, c <= 1, at the corners. The derivatives are finite differences of the forces,
/// so a cell depends on the 4 x 4 x 4 points around it. All leaves around a slot use the same
/// derivatives, so the force has continuous first derivatives, also between leaves of different
/// level. The error is proportional to spacing^3. The force is not conservative, and the stiffness
/// (its exact derivative) need not be symmetric.
///
/// Ghosts replace unsolved points. A corner's coverage is at most the smallest coverage of the
/// points in its finite differences, so it is 0 if one of them is a ghost.
class TricubicField : public CellField {
 public:
  /// Error if no point of the space is solved.
  explicit TricubicField(const SpaceTable& space) : TricubicField(CellData(space)) {}

  /// Derivatives of the force at a slot, N / m^(a + b + c). Column a + 2 b + 4 c has the derivative
  /// (a, b, c) of the three force components in rows 0 to 2. Row 3 is zero and pads the columns to
  /// the length of a register.
  using Node = Eigen::Matrix<double, 4, 8>;

 protected:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

 private:
  explicit TricubicField(CellData data);

  std::vector<Node> nodes_;  ///< per slot
};

}  // namespace palpate
