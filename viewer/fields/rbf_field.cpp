#include "viewer/fields/rbf_field.hpp"

#include "common/base/error.hpp"

namespace palpate {
namespace {

std::string_view nameOf(RbfKernel kernel, bool has_tail) {
  if (kernel == RbfKernel::linear) return has_tail ? "rbf-linear-tail" : "rbf-linear";
  return has_tail ? "rbf-cubic-tail" : "rbf-cubic";
}

/// In units of the spacing.
std::vector<RbfBlock> blocksOf(const SpaceTable& space, const RbfWeights& weights) {
  std::vector<RbfBlock> blocks(static_cast<std::size_t>(weights.weights.rows() + 7) / rbf_lanes);
  std::size_t place = 0;
  for (std::int32_t n = 0; n < space.lattice.size(); ++n) {
    if (!isSolved(space.points[n].tag)) continue;
    RbfBlock& block = blocks[place / rbf_lanes];
    const Eigen::Vector3d position = space.lattice.displacement(n) / space.lattice.spacing();
    for (int axis = 0; axis < 3; ++axis) {
      block.position[axis][place % rbf_lanes] = position[axis];
      block.weight[axis][place % rbf_lanes] =
          weights.weights(static_cast<Eigen::Index>(place), axis);
    }
    ++place;
  }
  return blocks;
}

}  // namespace

RbfField::RbfField(const SpaceTable& space, RbfKernel kernel, bool has_tail,
                   const RbfKernels& kernels)
    : CellField(CellData(space)),
      weights_(solveRbfWeights(space, kernel)[has_tail ? 1 : 0]),
      sums_(kernel == RbfKernel::linear ? kernels.linear : kernels.cubic),
      blocks_(blocksOf(space, weights_)) {
  if (!weights_.accurate())
    throw failure(
        "active node {}: {} has no accurate solution for its {} solved points (residual {:.2g} "
        "of the largest force, condition {:.2g}); choose another method",
        space.patch.name, nameOf(kernel, has_tail), weights_.weights.rows(), weights_.residual,
        weights_.condition);
}

std::string_view RbfField::name() const { return nameOf(weights_.kernel, weights_.has_tail); }

void RbfField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                           ForceSample& sample) const noexcept {
  const double spacing = tree().spacing();
  const Eigen::Vector3d p =
      (tree().displacement(tree().corners(leaf)[0]) + tree().edge(leaf) * local) / spacing;
  RbfSums sums;
  sums_(blocks_.data(), blocks_.size(), p.data(), sums);
  for (int i = 0; i < 3; ++i) {
    sample.force[i] = sums.value[i];
    for (int j = 0; j < 3; ++j) sample.stiffness(i, j) = sums.gradient[i][j];
  }
  if (weights_.tail.rows() > 0) sample.force += weights_.tail.row(0).transpose();
  if (weights_.tail.rows() > 1) {
    sample.force += weights_.tail.bottomRows<3>().transpose() * p;
    sample.stiffness += weights_.tail.bottomRows<3>().transpose();
  }
  sample.stiffness /= spacing;
}

}  // namespace palpate
