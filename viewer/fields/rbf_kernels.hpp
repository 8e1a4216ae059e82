#pragma once

#include <cstddef>
#include <vector>

/// Sums of radial functions over eight centres at once (structure of arrays). One source is
/// compiled once per CPU family, like worker/elements/element_kernels.hpp.
namespace palpate {

inline constexpr std::size_t rbf_lanes = 8;

/// Eight centres with a weight per force component. A block that is not full has zero weights.
struct alignas(64) RbfBlock {
  double position[3][rbf_lanes] = {};
  double weight[3][rbf_lanes] = {};
};

/// Sum over the centres of w phi(|p - centre|), and its derivative.
struct RbfSums {
  double value[3] = {};
  double gradient[3][3] = {};  ///< [component][axis]
};

/// Eight centres of a Hermite-Birkhoff interpolation: each contributes
/// a phi + b . grad phi + C : grad grad phi of d = p - centre.
struct alignas(64) HermiteBlock {
  double position[3][rbf_lanes] = {};
  double a[rbf_lanes] = {};
  double b[3][rbf_lanes] = {};
  double C[6][rbf_lanes] = {};  ///< xx, yy, zz, yz, xz, xy of the symmetric matrix
};

/// Sum of the contributions with its derivatives.
struct HermiteSums {
  double value = 0;
  double gradient[3] = {};
  double hessian[6] = {};  ///< as in HermiteBlock::C
};

/// The kernels of one CPU family. `count` blocks are read; sums are overwritten. Real time.
/// Families agree to the rounding, not to the bit.
struct RbfKernels {
  const char* family;
  void (*linear)(const RbfBlock* blocks, std::size_t count, const double p[3],
                 RbfSums& sums) noexcept;
  void (*cubic)(const RbfBlock* blocks, std::size_t count, const double p[3],
                RbfSums& sums) noexcept;
  /// phi = r^7.
  void (*hermite)(const HermiteBlock* blocks, std::size_t count, const double p[3],
                  HermiteSums& sums) noexcept;
};

/// All that this CPU runs, fastest first: "avx512", "avx2", "baseline".
std::vector<const RbfKernels*> supportedRbfKernels();

}  // namespace palpate
