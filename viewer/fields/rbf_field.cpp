#include "viewer/fields/rbf_field.hpp"

#include <Eigen/LU>

#include "common/base/error.hpp"

namespace palpate {
namespace {

using Rows = RbfWeights::Rows;

std::string_view nameOf(RbfKernel kernel) {
  return kernel == RbfKernel::linear ? "rbf-linear" : "rbf-cubic";
}

/// Returns the indices of the solved lattice points. Error if there are none, or more than
/// most_rbf_points.
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

/// Solves for the weights and packs them into blocks. Positions are in units of the spacing.
std::vector<RbfBlock> solvedBlocks(const SpaceTable& space, RbfKernel kernel) {
  const RbfWeights solution = solveRbfWeights(space, kernel);
  if (!solution.accurate())
    throw failure(
        "active node {}: {} has no accurate solution for its {} solved points "
        "(residual {:.2g} of the largest force, condition {:.2g}); choose another method",
        space.patch.name, nameOf(kernel), solution.weights.rows(), solution.residual,
        solution.condition);
  PALPATE_ASSERT(solution.position.rows() == solution.weights.rows() && solution.weights.rows() > 0,
                 "solved points must exist, and each have a weight");
  const std::size_t count = at(solution.weights.rows());
  std::vector<RbfBlock> blocks((count - 1) / rbf_lanes + 1);
  for (std::size_t n = 0; n < count; ++n)
    for (int axis = 0; axis < 3; ++axis) {
      blocks[n / rbf_lanes].position[axis][n % rbf_lanes] = solution.position(n, axis);
      blocks[n / rbf_lanes].weight[axis][n % rbf_lanes] = solution.weights(n, axis);
    }
  return blocks;
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
  // The diagonal is zero, so the matrix has eigenvalues of both signs and no Cholesky factors.
  const Eigen::PartialPivLU<Eigen::MatrixXd> factors(matrix);
  solution.condition = 1 / factors.rcond();
  solution.weights = factors.solve(force);
  // One step of iterative refinement recovers the last digits, which are lost if the condition
  // number is large.
  solution.weights += factors.solve(force - matrix * solution.weights);
  const double largest = force.cwiseAbs().maxCoeff();
  const double error = (force - matrix * solution.weights).cwiseAbs().maxCoeff();
  solution.residual = !solution.weights.allFinite() ? std::numeric_limits<double>::infinity()
                      : largest > 0                 ? error / largest
                                                    : error;
  return solution;
}

RbfField::RbfField(const SpaceTable& space, RbfKernel kernel)
    : CellField(nameOf(kernel), CellData(space)),
      kernel_(kernel),
      blocks_(solvedBlocks(space, kernel)) {}

void RbfField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                           ForceSample& sample) const noexcept {
  const double spacing = tree().spacing();
  const Eigen::Vector3d place =
      (tree().displacement(tree().corners(leaf)[0]) + tree().edge(leaf) * local) / spacing;
  const double p[3] = {place.x(), place.y(), place.z()};
  const RbfSums sums =
      kernel_ == RbfKernel::linear ? linearRbfSums(blocks_, p) : cubicRbfSums(blocks_, p);
  sample.force = Eigen::Map<const Eigen::Vector3d>(sums.value);
  sample.stiffness =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(sums.gradient[0]) / spacing;
}

}  // namespace palpate
