#pragma once

#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// Tri-cubic interpolation of each component of the force: in a leaf the tensor product cubic
/// Hermite polynomial of the eight derivatives d^(a+b+c) h / dx^a dy^b dz^c, a, b, c <= 1, at its
/// corners. They are values of slots, the same for every leaf around, so the force has continuous
/// first derivatives, also where levels meet. Not conservative; the stiffness (its exact
/// derivative) need not be symmetric.
class HermiteField : public CellField {
 public:
  /// Where the first derivatives of the force come from.
  enum class Slopes {
    /// "hermite": the stiffnesses; mixed derivatives are one difference of them. Error spacing^4,
    /// spacing^3 next to points that are not solved.
    exact,
    /// "tricubic": differences of the forces, so that a cell needs the 4 x 4 x 4 points around it
    /// (Lekien and Marsden 2005). Error spacing^3. Ghosts supply points that are not solved;
    /// coverage counts corners whose differences use one as not solved.
    differences,
  };

  /// Error when no point of the space is solved.
  HermiteField(const SpaceTable& space, Slopes slopes) : HermiteField(CellData(space), slopes) {}

  /// Derivative (a, b, c) of the force, N / m^(a + b + c), in rows 0 to 2 of column a + 2 b + 4 c.
  /// Row 3 is zero: it makes columns as long as registers.
  using Node = Eigen::Matrix<double, 4, 8>;

 protected:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

 private:
  HermiteField(CellData data, Slopes slopes);

  std::vector<Node> nodes_;  ///< per slot
};

}  // namespace palpate
