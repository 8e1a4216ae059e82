#pragma once

#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// The paper's other baseline (Lekien and Marsden 2005): in a leaf each component of the force is
/// the tensor product cubic Hermite polynomial of the eight derivatives d^(a+b+c) h / dx^a dy^b
/// dz^c, a, b, c <= 1, at its corners. They are differences of the forces, so that a cell needs the
/// 4 x 4 x 4 points around it, and the same for every leaf around a slot: the force has continuous
/// first derivatives, also where levels meet. Error spacing^3. Not conservative; the stiffness (its
/// exact derivative) need not be symmetric.
///
/// Ghosts supply points that are not solved; coverage counts corners whose differences use one as
/// not solved.
class TricubicField : public CellField {
 public:
  /// Error when no point of the space is solved.
  explicit TricubicField(const SpaceTable& space) : TricubicField(CellData(space)) {}

  /// Derivative (a, b, c) of the force, N / m^(a + b + c), in rows 0 to 2 of column a + 2 b + 4 c.
  /// Row 3 is zero: it makes columns as long as registers.
  using Node = Eigen::Matrix<double, 4, 8>;

 protected:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

 private:
  explicit TricubicField(CellData data);

  std::vector<Node> nodes_;  ///< per slot
};

}  // namespace palpate
