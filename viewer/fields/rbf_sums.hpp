#pragma once

#include <cstddef>
#include <vector>

namespace palpate {

inline constexpr std::size_t rbf_lanes = 4;

/// Four centres of radial functions, with a weight per force component (structure of arrays).
/// Unused lanes have zero weights.
struct alignas(32) RbfBlock {
  double position[3][rbf_lanes] = {};
  double weight[3][rbf_lanes] = {};
};

/// Sum of w phi(|p - centre|) over all centres, and its derivative with respect to p.
struct RbfSums {
  double value[3] = {};
  double gradient[3][3] = {};  ///< [component][axis]
};

/// Returns the sums for phi(r) = r at p, a position in the unit of the centres. At a centre, the
/// derivative of that centre's term is undefined and set to zero. Real time: does not allocate,
/// lock, throw or log.
RbfSums linearRbfSums(const std::vector<RbfBlock>& blocks, const double (&p)[3]) noexcept;

/// Returns the sums for phi(r) = r^3; otherwise like the function above.
RbfSums cubicRbfSums(const std::vector<RbfBlock>& blocks, const double (&p)[3]) noexcept;

}  // namespace palpate
