#include "viewer/plot/widest_view.hpp"

#include <Eigen/Eigenvalues>

namespace palpate {

Eigen::Vector3d widestView(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) middle += point / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& point : points)
    spread += (point - middle) * (point - middle).transpose();
  const Eigen::Vector3d axis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
  return axis.y() > 0 ? Eigen::Vector3d(-axis) : axis;
}

}  // namespace palpate
