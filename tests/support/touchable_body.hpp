#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "tests/support/sample_dataset.hpp"

namespace palpate::test {

/// A convex, stiffening energy f (p.A p / 2 + b |p|^4 / 4) with f = `factor`. Its stiffness is
/// about 60 f N/m at rest and twice that at 20 mm. A is anisotropic, and stiffer by k k^T with k =
/// `stiff_along` (root of N/m). A hand can slide on this body without falling into a hole.
class ConvexEnergy : public AnalyticEnergy {
 public:
  explicit ConvexEnergy(double factor = 1,
                        const Eigen::Vector3d& stiff_along = Eigen::Vector3d::Zero());
  double energy(const Eigen::Vector3d& p) const override;
  Eigen::Vector3d gradient(const Eigen::Vector3d& p) const override;
  Eigen::Matrix3d hessian(const Eigen::Vector3d& p) const override;
  SymmetricSlope hessianSlope(const Eigen::Vector3d& p) const;

 private:
  double factor_;
  Eigen::Matrix3d at_rest_;
};

/// Returns the fields of a body whose node at `center` moves by p; nodes farther away move less.
NodalFields movedAround(const Problem& problem, const Eigen::Vector3d& center,
                        const Eigen::Vector3d& p);

/// A sealed dataset of a mesh, made in code: active nodes with ConvexEnergy and their own factors,
/// all points solved, and displacements that fall off with the distance from the active node.
struct TouchableBody {
  struct Active {
    std::int32_t node;
    double factor = 1;
    Eigen::Vector3d stiff_along = Eigen::Vector3d::Zero();
  };
  /// Fixes the nodes of group "zmin", which must not contain an active node.
  TouchableBody(Mesh mesh, const std::vector<Active>& active, double radius = 0.03,
                double spacing = 0.015);

  Problem problem;
  std::vector<SpaceTable> spaces;

  NodalFields fields(std::size_t space, std::int32_t point) const;
  /// Throws if the file cannot be written.
  void seal(const std::filesystem::path& file) const;
};

/// Returns all surface vertices except the fixed ones as active nodes, with a factor for each
/// position.
std::vector<TouchableBody::Active> wholeSurface(
    const Mesh& mesh, const std::function<double(const Eigen::Vector3d&)>& factor =
                          [](const Eigen::Vector3d&) { return 1.0; });

}  // namespace palpate::test
