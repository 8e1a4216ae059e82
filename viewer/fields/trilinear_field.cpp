#include "viewer/fields/trilinear_field.hpp"

#include <algorithm>

#include "common/base/index.hpp"

namespace palpate {
namespace {

std::vector<Eigen::Matrix3d> stiffnesses(const CellData& data) {
  std::vector<Eigen::Matrix3d> values;
  for (const Equilibrium& equilibrium : data.equilibria) values.push_back(equilibrium.stiffness);
  fillHanging(data.tree, values, [&](std::int32_t leaf, const Eigen::Vector3d& local) {
    const std::array<double, 8> weights = trilinearWeights(local);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (std::size_t c = 0; c < 8; ++c) sum += weights[c] * values[at(data.tree.corners(leaf)[c])];
    return sum;
  });
  return values;
}

}  // namespace

TrilinearField::TrilinearField(const CellData& data) : CellField(data, Limit::bound) {
  const std::vector<Eigen::Matrix3d> stiffness = stiffnesses(data);
  for (std::size_t leaf = 0; leaf < tree().leaves().size(); ++leaf) {
    const LeafCorners& corners = tree().corners(static_cast<std::int32_t>(leaf));
    Eigen::Vector3d bend = Eigen::Vector3d::Zero();  // N, along each axis
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t c = 0; c < 8; ++c)
        if (const std::size_t other = c | std::size_t{1} << axis; other != c)
          bend[axis] = std::max(
              bend[axis],
              (stiffness[at(corners[other])] - stiffness[at(corners[c])]).col(axis).norm() *
                  tree().edge(static_cast<std::int32_t>(leaf)));
    error_bound_.push_back(bend.sum() / 8);
  }
}

void TrilinearField::interpolate(std::int32_t leaf, const Eigen::Vector3d&,
                                 ForceSample& sample) const noexcept {
  sample.error_bound = error_bound_[at(leaf)];
}

}  // namespace palpate
