#include "viewer/plot/widest_view.hpp"

#include <Eigen/Eigenvalues>

namespace palpate {

Eigen::Vector3d widestView(const std::vector<Eigen::Vector3d>& points) {
  const Eigen::Map<const Eigen::Matrix3Xd> all(points.front().data(), 3, std::ssize(points));
  const Eigen::Matrix3Xd spread = all.colwise() - all.rowwise().mean();
  const Eigen::Vector3d axis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread * spread.transpose())
          .eigenvectors()
          .col(0);
  return axis.y() > 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace palpate
