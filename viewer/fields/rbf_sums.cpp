#include "viewer/fields/rbf_sums.hpp"

#include <cmath>

#include "common/base/cpu_family.hpp"

namespace palpate {
namespace {

/// Values of four centres, one register of AVX2. The twelve sums then stay in registers.
using Pack = double __attribute__((vector_size(rbf_lanes * sizeof(double))));

[[gnu::always_inline]] inline Pack load(const double* values) {
  return *reinterpret_cast<const Pack*>(values);
}

[[gnu::always_inline]] inline Pack squareRoot(const Pack& x) {
  return Pack{std::sqrt(x[0]), std::sqrt(x[1]), std::sqrt(x[2]), std::sqrt(x[3])};
}

/// Computes the sums for phi(r) = r^power.
template <int power>
[[gnu::always_inline]] inline RbfSums addUp(const RbfBlock* blocks, std::size_t count,
                                            const double* p) noexcept {
  // Keeps 1 / r finite at a centre, where it is then multiplied by zero.
  const Pack tiny = Pack{} + 1e-200;
  Pack value[3] = {}, gradient[3][3] = {};
  for (std::size_t n = 0; n < count; ++n) {
    const RbfBlock& block = blocks[n];
    const Pack d[3] = {p[0] - load(block.position[0]), p[1] - load(block.position[1]),
                       p[2] - load(block.position[2])};
    const Pack squared = ((tiny + d[0] * d[0]) + d[1] * d[1]) + d[2] * d[2];
    const Pack r = squareRoot(squared);
    const Pack scale = power == 1 ? 1 / r : r;  // phi / r^2, which is also phi' / (power * r)
    for (int i = 0; i < 3; ++i) {
      const Pack w = load(block.weight[i]) * scale;
      value[i] += w * squared;
      for (int j = 0; j < 3; ++j) gradient[i][j] += w * d[j];
    }
  }
  const auto sum = [](const Pack& pack) { return (pack[0] + pack[1]) + (pack[2] + pack[3]); };
  RbfSums sums;
  for (int i = 0; i < 3; ++i) {
    sums.value[i] = sum(value[i]);
    for (int j = 0; j < 3; ++j) sums.gradient[i][j] = power * sum(gradient[i][j]);
  }
  return sums;
}

}  // namespace

PALPATE_PER_CPU_FAMILY RbfSums linearRbfSums(const std::vector<RbfBlock>& blocks,
                                             const double (&p)[3]) noexcept {
  return addUp<1>(blocks.data(), blocks.size(), p);
}

PALPATE_PER_CPU_FAMILY RbfSums cubicRbfSums(const std::vector<RbfBlock>& blocks,
                                            const double (&p)[3]) noexcept {
  return addUp<3>(blocks.data(), blocks.size(), p);
}

}  // namespace palpate
