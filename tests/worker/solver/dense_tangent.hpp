#pragma once

#include "worker/solver/system.hpp"

namespace palpate::test {

/// The whole symmetric matrix, including its border.
inline Eigen::MatrixXd dense(const System& system, const Tangent& tangent) {
  const int n = system.unknowns(), m = static_cast<int>(tangent.border.cols());
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + m, n + m);
  for (std::size_t entry = 0; entry < tangent.values.size(); ++entry) {
    const int row = system.pattern().row[entry] - 1, column = system.pattern().column[entry] - 1;
    K(row, column) = K(column, row) = tangent.values[entry];
  }
  K.topRightCorner(n, m) = tangent.border;
  K.bottomLeftCorner(m, n) = tangent.border.transpose();
  return K;
}

}  // namespace palpate::test
