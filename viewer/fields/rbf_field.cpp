#include "viewer/fields/rbf_field.hpp"

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/base/index.hpp"

namespace palpate {
namespace {

std::string_view nameOf(RbfKernel kernel) {
  return kernel == RbfKernel::linear ? "rbf-linear" : "rbf-cubic";
}

/// In units of the spacing.
std::vector<RbfBlock> solvedBlocks(const SpaceTable& space, RbfKernel kernel) {
  const RbfWeights solution = solveRbfWeights(space, kernel);
  if (!solution.accurate())
    throw failure(
        "active node {}: {} has no accurate solution for its {} solved points "
        "(residual {:.2g} of the largest force, condition {:.2g}); choose another method",
        space.patch.name, nameOf(kernel), solution.weights.rows(), solution.residual,
        solution.condition);
  std::vector<RbfBlock> blocks(at(solution.weights.rows() - 1) / rbf_lanes + 1);
  std::size_t place = 0;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[at(n)].tag)) continue;
    RbfBlock& block = blocks[place / rbf_lanes];
    const Eigen::Vector3d position = space.lattice.displacement(n) / space.lattice.spacing();
    for (int axis = 0; axis < 3; ++axis) {
      block.position[axis][place % rbf_lanes] = position[axis];
      block.weight[axis][place % rbf_lanes] =
          solution.weights(static_cast<Eigen::Index>(place), axis);
    }
    ++place;
  }
  PALPATE_ASSERT(static_cast<Eigen::Index>(place) == solution.weights.rows(),
                 "there is a weight for every solved point");
  return blocks;
}

}  // namespace

RbfField::RbfField(const SpaceTable& space, RbfKernel kernel)
    : CellField(CellData(space)), kernel_(kernel), blocks_(solvedBlocks(space, kernel)) {}

std::string_view RbfField::name() const { return nameOf(kernel_); }

void RbfField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                           ForceSample& sample) const noexcept {
  const Eigen::Vector3d place =
      tree().displacement(tree().corners(leaf)[0]) + tree().edge(leaf) * local;
  const double spacing = tree().spacing();
  const double p[3] = {place.x() / spacing, place.y() / spacing, place.z() / spacing};
  const RbfSums sums =
      kernel_ == RbfKernel::linear ? linearRbfSums(blocks_, p) : cubicRbfSums(blocks_, p);
  for (int i = 0; i < 3; ++i) {
    sample.force[i] = sums.value[i];
    for (int j = 0; j < 3; ++j) sample.stiffness(i, j) = sums.gradient[i][j] / spacing;
  }
}

}  // namespace palpate
