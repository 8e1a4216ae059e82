#include "viewer/fields/rbf_field.hpp"

#include <Eigen/LU>
#include <cmath>

#include "common/base/error.hpp"

namespace palpate {
namespace {

using Rows = RbfWeights::Rows;

std::string_view nameOf(RbfKernel kernel) {
  return kernel == RbfKernel::linear ? "rbf-linear" : "rbf-cubic";
}

/// The lattice numbers of solved points, as many as a matrix can be made of.
std::vector<std::int32_t> solvedPoints(const SpaceTable& space) {
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
  return solved;
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

RbfWeights accurateWeights(const SpaceTable& space, RbfKernel kernel) {
  RbfWeights solution = solveRbfWeights(space, kernel);
  if (!solution.accurate())
    throw failure(
        "active node {}: {} has no accurate solution for its {} solved points "
        "(residual {:.2g} of the largest force, condition {:.2g}); choose another method",
        space.patch.name, nameOf(kernel), solution.weights.rows(), solution.residual,
        solution.condition);
  return solution;
}

}  // namespace

RbfWeights solveRbfWeights(const SpaceTable& space, RbfKernel kernel) {
  const std::vector<std::int32_t> solved = solvedPoints(space);
  RbfWeights solution;
  solution.position.resize(solved.size(), 3);
  Rows force(solved.size(), 3);
  for (std::size_t row = 0; row < solved.size(); ++row) {
    solution.position.row(row) = space.lattice.displacement(solved[row]) / space.lattice.spacing();
    force.row(row) = space.points[at(solved[row])].equilibrium.force;
  }
  const Eigen::MatrixXd matrix = kernelMatrix(kernel, solution.position);
  // The diagonal is zero, so the matrix has eigenvalues of both signs: no Cholesky.
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(matrix);
  solution.condition = 1 / factors.rcond();
  solution.weights = factors.solve(force);
  // A step of refinement takes the last digits that the condition cost.
  solution.weights += factors.solve(force - matrix * solution.weights);
  const double largest = force.cwiseAbs().maxCoeff();
  const double error = (force - matrix * solution.weights).cwiseAbs().maxCoeff();
  solution.residual = !solution.weights.allFinite() ? std::numeric_limits<double>::infinity()
                      : largest > 0                 ? error / largest
                                                    : error;
  return solution;
}

RbfField::RbfField(const SpaceTable& space, RbfKernel kernel)
    : CellField(nameOf(kernel), CellData(space)), kernel_(kernel) {
  const RbfWeights solution = accurateWeights(space, kernel);
  places_.setZero(4, solution.position.rows());
  places_.topRows<3>() = solution.position.transpose();
  weights_.setZero(4, solution.weights.rows());
  weights_.topRows<3>() = solution.weights.transpose();
}

void RbfField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                           ForceSample& sample) const noexcept {
  const double spacing = tree().spacing();
  Eigen::Vector4d place = Eigen::Vector4d::Zero();
  place.head<3>() =
      (tree().displacement(tree().corners(leaf)[0]) + tree().edge(leaf) * local) / spacing;
  const bool is_linear = kernel_ == RbfKernel::linear;
  // The gradient but for the power of r, and the value in the last column.
  Eigen::Matrix4d sums = Eigen::Matrix4d::Zero();
  for (Eigen::Index n = 0; n < places_.cols(); ++n) {
    Eigen::Vector4d terms = place - places_.col(n);
    // So that 1 / r is finite at a solved point, where it is multiplied by zero.
    terms[3] = terms.squaredNorm() + 1e-200;
    const double r = std::sqrt(terms[3]);
    sums += (weights_.col(n) * (is_linear ? 1 / r : r)) * terms.transpose();
  }
  sample.force = sums.topRightCorner<3, 1>();
  sample.stiffness = sums.topLeftCorner<3, 3>() * (is_linear ? 1 : 3) / spacing;
}

}  // namespace palpate
