#include "common/interpolation/rbf_weights.hpp"

#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/interpolation/conditional_system.hpp"
#include "common/space/space_table.hpp"

namespace palpate {
namespace {

using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

double radial(RbfKernel kernel, double squared) {
  const double r = std::sqrt(squared);
  return kernel == RbfKernel::linear ? r : r * squared;
}

/// -r is definite on weights whose sum is zero, r^3 on those that are orthogonal to linear
/// functions too.
double definiteSign(RbfKernel kernel) { return kernel == RbfKernel::linear ? -1 : 1; }

struct Points {
  Rows position;  ///< in spacings
  Rows force;     ///< N
};

Points solvedPoints(const SpaceTable& space) {
  Points points;
  Eigen::Index count = 0;
  for (const PointRecord& point : space.points) count += isSolved(point.tag) ? 1 : 0;
  if (count == 0)
    throw failure("active node {}: no lattice point was solved, so there is nothing to interpolate",
                  space.patch.name);
  if (static_cast<std::size_t>(count) > most_rbf_points)
    throw failure(
        "active node {}: {} solved points are too many for global radial functions (at most "
        "{}); choose another method",
        space.patch.name, count, most_rbf_points);
  points.position.resize(count, 3);
  points.force.resize(count, 3);
  for (std::int32_t n = 0, row = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[n].tag)) continue;
    points.position.row(row) = space.lattice.displacement(n) / space.lattice.spacing();
    points.force.row(row++) = space.points[n].equilibrium.force;
  }
  return points;
}

Eigen::MatrixXd kernelMatrix(RbfKernel kernel, const Rows& position) {
  const Eigen::Index n = position.rows();
  Eigen::MatrixXd A(n, n);
  for (Eigen::Index column = 0; column < n; ++column)
    for (Eigen::Index row = 0; row < n; ++row)
      A(row, column) = definiteSign(kernel) *
                       radial(kernel, (position.row(row) - position.row(column)).squaredNorm());
  return A;
}

Eigen::MatrixXd polynomials(RbfKernel kernel, const Rows& position) {
  Eigen::MatrixXd P(position.rows(), kernel == RbfKernel::linear ? 1 : 4);
  P.col(0).setOnes();
  if (kernel == RbfKernel::cubic) P.rightCols<3>() = position;
  return P;
}

/// What is missing to the forces.
Rows defect(const RbfWeights& solution, const Points& points, const Eigen::MatrixXd& P) {
  Rows rest = points.force;
  if (solution.has_tail) rest -= P * solution.tail;
  for (Eigen::Index row = 0; row < rest.rows(); ++row)
    for (Eigen::Index centre = 0; centre < rest.rows(); ++centre)
      rest.row(row) -=
          radial(solution.kernel,
                 (points.position.row(row) - points.position.row(centre)).squaredNorm()) *
          solution.weights.row(centre);
  return rest;
}

void add(RbfWeights& solution, const ConditionalSystem& system, const Rows& forces) {
  if (solution.has_tail) {
    const auto [weights, tail] = system.withTail(forces);
    solution.weights += definiteSign(solution.kernel) * weights;
    solution.tail += tail;
  } else {
    solution.weights += definiteSign(solution.kernel) * system.withoutTail(forces);
  }
}

RbfWeights solve(RbfKernel kernel, bool has_tail, const ConditionalSystem& system,
                 const Points& points, const Eigen::MatrixXd& P) {
  RbfWeights solution;
  solution.kernel = kernel;
  solution.has_tail = has_tail;
  solution.condition = system.condition();
  solution.residual = std::numeric_limits<double>::infinity();
  solution.weights = Rows::Zero(points.force.rows(), 3);
  solution.tail = Rows::Zero(has_tail ? P.cols() : 0, 3);
  if (!system.definite()) return solution;

  add(solution, system, points.force);
  add(solution, system,
      defect(solution, points, P));  // takes the last digits that the condition cost
  const double largest = points.force.cwiseAbs().maxCoeff();
  const double error = defect(solution, points, P).cwiseAbs().maxCoeff();
  if (solution.weights.allFinite() && std::isfinite(error))
    solution.residual = largest > 0 ? error / largest : error;
  return solution;
}

}  // namespace

std::vector<RbfWeights> solveRbfWeights(const SpaceTable& space, RbfKernel kernel) {
  // The sizes decide in which order Eigen adds up. Fixed ones make the bits of a dataset the same
  // everywhere.
  Eigen::setCpuCacheSizes(32 << 10, 512 << 10, 4 << 20);
  const Points points = solvedPoints(space);
  const Eigen::MatrixXd P = polynomials(kernel, points.position);
  const ConditionalSystem system(kernelMatrix(kernel, points.position), P);
  return {solve(kernel, false, system, points, P), solve(kernel, true, system, points, P)};
}

}  // namespace palpate
