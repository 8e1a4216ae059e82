#pragma once

#include <vector>

#include "common/interpolation/rbf_weights.hpp"
#include "viewer/fields/cell_field.hpp"
#include "viewer/fields/rbf_kernels.hpp"

namespace palpate {

/// The paper's other method: one sum of radial functions over all solved points
/// (common/interpolation/rbf_weights.hpp). No cells, so the force has continuous derivatives
/// everywhere (of r: but at the solved points) and the whole ball is answered the same way. A query
/// costs time for every solved point, and the force is not conservative.
class RbfField : public CellField {
 public:
  /// Solves for the weights. Error when the space has no solved point, too many, or points that
  /// these radial functions cannot tell apart (a single one, without a tail). `kernels` must be one
  /// that the CPU runs.
  RbfField(const SpaceTable& space, RbfKernel kernel, bool has_tail,
           const RbfKernels& kernels = *supportedRbfKernels().front());
  std::string_view name() const override;

 private:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

  RbfWeights weights_;
  decltype(RbfKernels::linear) sums_;
  std::vector<RbfBlock> blocks_;
};

}  // namespace palpate
