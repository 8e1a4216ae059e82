#include "viewer/fields/rbf_weights.hpp"

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "common/base/error.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

using Rows = decltype(RbfWeights::weights);

struct Points {
  Rows position;  ///< in spacings
  Rows force;     ///< N
};

Points solvedPoints(const SpaceTable& space) {
  std::vector<std::int32_t> solved;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n)
    if (isSolved(space.points[at(n)].tag)) solved.push_back(n);
  if (solved.empty())
    throw failure("active node {}: no lattice point was solved, so there is nothing to interpolate",
                  space.patch.name);
  if (solved.size() > most_rbf_points)
    throw failure(
        "active node {}: {} solved points are too many for global radial functions (at most {}); "
        "choose another method",
        space.patch.name, solved.size(), most_rbf_points);
  const auto count = static_cast<Eigen::Index>(solved.size());
  Points points{Rows(count, 3), Rows(count, 3)};
  for (Eigen::Index row = 0; row < count; ++row) {
    const std::int32_t n = solved[at(row)];
    points.position.row(row) = space.lattice.displacement(n) / space.lattice.spacing();
    points.force.row(row) = space.points[at(n)].equilibrium.force;
  }
  return points;
}

Eigen::MatrixXd kernelMatrix(RbfKernel kernel, const Rows& position) {
  const Eigen::Index n = position.rows();
  Eigen::MatrixXd matrix(n, n);
  for (Eigen::Index column = 0; column < n; ++column)
    for (Eigen::Index row = 0; row < n; ++row) {
      const double r = (position.row(row) - position.row(column)).norm();
      matrix(row, column) = kernel == RbfKernel::linear ? r : r * r * r;
    }
  return matrix;
}

}  // namespace

RbfWeights solveRbfWeights(const SpaceTable& space, RbfKernel kernel) {
  const Points points = solvedPoints(space);
  const Eigen::MatrixXd matrix = kernelMatrix(kernel, points.position);
  // The diagonal is zero, so the matrix has eigenvalues of both signs: no Cholesky.
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(matrix);
  RbfWeights solution;
  solution.condition = 1 / factors.rcond();
  solution.weights = factors.solve(points.force);
  // A step of refinement takes the last digits that the condition cost.
  solution.weights += factors.solve(points.force - matrix * solution.weights);
  const double largest = points.force.cwiseAbs().maxCoeff();
  const double error = (points.force - matrix * solution.weights).cwiseAbs().maxCoeff();
  solution.residual = !solution.weights.allFinite() ? std::numeric_limits<double>::infinity()
                      : largest > 0                 ? error / largest
                                                    : error;
  return solution;
}

}  // namespace palpate
