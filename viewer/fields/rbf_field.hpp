#pragma once

#include <vector>

#include "viewer/fields/cell_field.hpp"
#include "viewer/fields/rbf_sums.hpp"
#include "viewer/fields/rbf_weights.hpp"

namespace palpate {

/// The paper's other method: one sum of radial functions over all solved points (rbf_weights.hpp).
/// No cells, so the force has continuous derivatives everywhere (of r: but at the solved points)
/// and the whole ball is answered the same way. A query costs time for every solved point, and the
/// force is not conservative.
class RbfField : public CellField {
 public:
  /// Solves for the weights. Error when the space has no solved point, too many, or points that
  /// these radial functions cannot tell apart (a single one).
  RbfField(const SpaceTable& space, RbfKernel kernel);
  std::string_view name() const override;

 private:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

  RbfKernel kernel_;
  std::vector<RbfBlock> blocks_;
};

}  // namespace palpate
