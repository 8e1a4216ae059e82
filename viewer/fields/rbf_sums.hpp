#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

inline constexpr std::size_t rbf_lanes = 4;

/// Four centres of radial functions, with a weight per force component (structure of arrays). A
/// block that is not full has zero weights.
struct alignas(32) RbfBlock {
  double position[3][rbf_lanes] = {};
  double weight[3][rbf_lanes] = {};
};

/// Sum over the centres of w phi(|p - centre|), and its derivative.
struct RbfSums {
  double value[3] = {};
  double gradient[3][3] = {};  ///< [component][axis]
};

/// The sums of phi(r) = r at p, which is in the same unit as the centres. At a centre its own
/// derivative, which is not defined, counts as zero. Real time: does not allocate, lock, throw or
/// log.
RbfSums linearRbfSums(const std::vector<RbfBlock>& blocks, const double (&p)[3]) noexcept;

/// The same for phi(r) = r^3.
RbfSums cubicRbfSums(const std::vector<RbfBlock>& blocks, const double (&p)[3]) noexcept;

}  // namespace palpate
