#include "viewer/fields/trilinear_field.hpp"

#include <algorithm>

namespace palpate {

TrilinearField::TrilinearField(const CellData& data) : CellField("trilinear", data, Limit::bound) {
  std::vector<Eigen::Matrix3d> stiffness = mapped(data.equilibria, &Equilibrium::stiffness);
  // Hanging slots have no equilibrium of their own.
  fillHangingTrilinearly(tree(), stiffness);
  for (std::int32_t leaf = 0; leaf < std::ssize(tree().leaves()); ++leaf) {
    const LeafCorners& corners = tree().corners(leaf);
    // Largest change of the stiffness along each axis, times the edge length; in newtons.
    Eigen::Vector3d bend = Eigen::Vector3d::Zero();
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t c = 0; c < 8; ++c)
        if (const std::size_t other = c | std::size_t{1} << axis; other != c)
          bend[axis] = std::max(
              bend[axis],
              (stiffness[at(corners[other])] - stiffness[at(corners[c])]).col(axis).norm() *
                  tree().edge(leaf));
    error_bound_.push_back(bend.sum() / 8);
  }
}

void TrilinearField::interpolate(std::int32_t leaf, const Eigen::Vector3d&,
                                 ForceSample& sample) const noexcept {
  sample.error_bound = error_bound_[at(leaf)];
}

}  // namespace palpate
