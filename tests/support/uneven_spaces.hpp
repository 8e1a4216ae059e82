#pragma once

#include <utility>

#include "common/base/index.hpp"
#include "tests/support/failed_point.hpp"
#include "tests/support/points_in_ball.hpp"
#include "tests/support/sample_dataset.hpp"

/// Configuration spaces that are not uniform.
namespace palpate::test {

/// Returns a space whose points are all solved, after splitting these cells of `lattice` (1024
/// units wide) one after the other.
inline SpaceTable splitSpace(Lattice lattice, std::vector<LatticeCell> splits,
                             const AnalyticEnergy& energy) {
  for (const LatticeCell& cell : splits) {
    const std::int32_t half = 512 >> cell.level;
    for (int n = 0; n < 27; ++n) {
      const LatticePoint point = {cell.lowest[0] + half * (n % 3),
                                  cell.lowest[1] + half * (n / 3 % 3),
                                  cell.lowest[2] + half * (n / 9)};
      if (!lattice.indexOf(point)) lattice.add(point);
    }
  }
  SpaceTable space = solvedSpace(lattice, energy);
  space.splits = std::move(splits);
  return space;
}

/// Two neighbouring cells are split, and an eighth of one of them again.
inline const std::vector<LatticeCell> three_sizes = {
    {{0, 0, 0}, 0}, {{1024, 0, 0}, 0}, {{512, 512, 512}, 1}};

/// Returns the space with these points failed. Their records hold numbers that must not be read.
inline SpaceTable without(SpaceTable space, const std::vector<LatticePoint>& points) {
  for (const LatticePoint& point : points) {
    PointRecord& record = space.points[at(*space.lattice.indexOf(point))];
    record = failedPoint();
    record.equilibrium.force.setConstant(1e9);
  }
  return space;
}

/// A space in the ball of points_in_ball.hpp, with StiffeningEnergy. The cell between the origin
/// and (1, 1, 1) is split once, and all its corners are solved.
inline SpaceTable refinedSpace(double spacing) {
  return splitSpace(Lattice(radius, spacing, 1024), {{{0, 0, 0}, 0}}, StiffeningEnergy());
}

/// A space in the same ball with unsplit cells of 5 mm and five unsolved points.
inline SpaceTable holedSpace() {
  return without(solvedSpace(Lattice(radius, 0.005), StiffeningEnergy()),
                 {{1, 0, 0}, {1, 1, 0}, {0, -2, 1}, {0, -2, 2}, {-1, -1, -1}});
}

/// Two branches of StiffeningEnergy that meet at the plane x = `at`: beyond it the force along y is
/// larger by `force_jump`, and the energy lower by `lost`.
class JumpingEnergy : public AnalyticEnergy {
 public:
  explicit JumpingEnergy(double at, double force_jump = 5, double lost = 0)
      : at_(at), force_jump_(force_jump), lost_(lost) {}
  double energy(const Eigen::Vector3d& p) const override {
    return smooth_.energy(p) - (p.x() > at_ ? force_jump_ * p.y() + lost_ : 0);
  }
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const override {
    return smooth_.gradient(p) - Eigen::Vector3d(0, p.x() > at_ ? force_jump_ : 0, 0);
  }
  Eigen::Matrix3d hessian(const Eigen::Vector3d& p) const override { return smooth_.hessian(p); }

 private:
  StiffeningEnergy smooth_;
  double at_, force_jump_, lost_;
};

/// A space in the ball of points_in_ball.hpp, with cells of 5 mm and two branches that meet between
/// lattice planes.
inline SpaceTable branchedSpace() {
  return solvedSpace(Lattice(radius, 0.005), JumpingEnergy(0.007));
}

}  // namespace palpate::test
