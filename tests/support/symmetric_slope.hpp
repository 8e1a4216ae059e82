#pragma once

#include "common/space/configuration.hpp"

namespace palpate::test {

/// Returns the slope of the product of a constant symmetric matrix and a scalar with this gradient.
inline SymmetricSlope slopeOf(const Eigen::Matrix3d& symmetric, const Eigen::Vector3d& gradient) {
  SymmetricSlope slope;
  for (std::size_t c = 0; c < symmetric_axes.size(); ++c)
    slope.row(static_cast<Eigen::Index>(c)) =
        symmetric(symmetric_axes[c][0], symmetric_axes[c][1]) * gradient;
  return slope;
}

}  // namespace palpate::test
