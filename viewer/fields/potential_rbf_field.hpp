#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "viewer/fields/cell_field.hpp"
#include "viewer/fields/hermite_rbf.hpp"

namespace palpate {

/// The stored energy as a Hermite-Birkhoff interpolation (viewer/fields/hermite_rbf.hpp) of
/// energies, forces and stiffnesses; force = -grad E and stiffness = -Hessian, so conservative like
/// PotentialField. It needs no lattice: the points may lie anywhere, and every displacement of the
/// ball is answered the same way.
///
/// One interpolation over all points when they are few. Otherwise a partition of unity: the ball is
/// covered by overlapping balls around the cells of an octree, each with an interpolation of the
/// solved points in it (and of the nearest, where they are too few); E is their mean, weighted by
/// Wendland's function of class C2. So force and stiffness are continuous everywhere, and a query
/// takes a bounded time.
class PotentialRbfField : public CellField {
 public:
  /// Error when the space has no solved point, or points too close to be told apart. `kernels` must
  /// be one that the CPU runs.
  explicit PotentialRbfField(const SpaceTable& space,
                             const RbfKernels& kernels = *supportedRbfKernels().front());
  std::string_view name() const override { return "potential-rbf"; }
  std::size_t patches() const { return patches_.size(); }

 private:
  /// Lengths in spacings.
  struct Patch {
    Eigen::Vector3d centre;
    double radius;  ///< of its ball, in which its weight is not zero
    double unit;    ///< of its interpolation's coordinates
    HermiteRbf energy;
  };
  /// A cube of the octree.
  struct Cell {
    Eigen::Vector3d centre;
    double half;
    std::int32_t children = -1;        ///< the first of eight; -1: a leaf
    std::int32_t first = 0, last = 0;  ///< of a leaf: range of near_
  };
  struct Points;

  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;
  void divide(std::int32_t cell, int level, const Points& points);
  void addPatch(const Cell& cell, const Points& points);
  void findNear();
  const Cell& leafAt(const Eigen::Vector3d& p) const noexcept;
  Jet blend(const Cell& leaf, const Eigen::Vector3d& p) const noexcept;

  const RbfKernels& kernels_;
  std::vector<Patch> patches_;
  std::vector<Cell> cells_;         ///< the roots first, x slowest
  std::int32_t roots_ = 0;          ///< per axis
  std::vector<std::int32_t> near_;  ///< per leaf: patches whose balls reach into it
};

}  // namespace palpate
