// Included once per CPU family, with PALPATE_KERNEL_NAMESPACE set to a name of its own and the
// compiler flags of that family. Nothing here may be an inline function of another header: the
// linker would keep one family's copy for all.
#include <immintrin.h>

#include "viewer/fields/rbf_kernels.hpp"

namespace palpate::PALPATE_KERNEL_NAMESPACE {
namespace {

#define PALPATE_INLINE [[gnu::always_inline]] inline

// As wide as a register, so that all sums stay in registers.
#if defined(__AVX512F__)
constexpr std::size_t lanes = 8;
#elif defined(__AVX__)
constexpr std::size_t lanes = 4;
#else
constexpr std::size_t lanes = 2;
#endif
using Pack = double __attribute__((vector_size(lanes * sizeof(double))));

PALPATE_INLINE Pack load(const double* values) { return *reinterpret_cast<const Pack*>(values); }

PALPATE_INLINE double sum(Pack pack) {
  double total = 0;
  for (std::size_t l = 0; l < lanes; ++l) total += pack[l];
  return total;
}

PALPATE_INLINE Pack squareRoot(Pack x) {
#if defined(__AVX512F__)
  return reinterpret_cast<Pack>(_mm512_sqrt_pd(reinterpret_cast<__m512d>(x)));
#elif defined(__AVX__)
  return reinterpret_cast<Pack>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(x)));
#else
  return reinterpret_cast<Pack>(_mm_sqrt_pd(reinterpret_cast<__m128d>(x)));
#endif
}

/// Of a squared length. Not zero where the length is, so that its inverse is finite; there it is
/// multiplied by zero.
PALPATE_INLINE Pack square(const Pack (&d)[3]) {
  const Pack tiny = Pack{} + 1e-200;
  return ((tiny + d[0] * d[0]) + d[1] * d[1]) + d[2] * d[2];
}

PALPATE_INLINE Pack inverseSquareRoot(Pack x) {
#if defined(__AVX512F__)
  // 14 bits, then a step of fourth order: 1/sqrt(1 - e) = 1 + e/2 + 3/8 e^2 + 5/16 e^3 + ...
  const auto y = reinterpret_cast<Pack>(_mm512_rsqrt14_pd(reinterpret_cast<__m512d>(x)));
  const Pack e = 1 - x * y * y;
  return y + y * e * (0.5 + e * (0.375 + e * 0.3125));
#else
  return 1 / squareRoot(x);
#endif
}

/// factor(r^2) is phi / r^2 and, but for a number that is applied at the end, phi' / r.
template <class Factor>
PALPATE_INLINE void addUp(const RbfBlock* blocks, std::size_t count, const double (&p)[3],
                          double slope, Factor factor, RbfSums& sums) {
  Pack value[3] = {}, gradient[3][3] = {};
  for (std::size_t n = 0; n < count * rbf_lanes; n += lanes) {
    const RbfBlock& block = blocks[n / rbf_lanes];
    const std::size_t l = n % rbf_lanes;
    const Pack d[3] = {p[0] - load(block.position[0] + l), p[1] - load(block.position[1] + l),
                       p[2] - load(block.position[2] + l)};
    const Pack squared = square(d);
    const Pack scale = factor(squared);
    for (int i = 0; i < 3; ++i) {
      const Pack w = load(block.weight[i] + l) * scale;
      value[i] += w * squared;
      for (int j = 0; j < 3; ++j) gradient[i][j] += w * d[j];
    }
  }
  for (int i = 0; i < 3; ++i) {
    sums.value[i] = sum(value[i]);
    for (int j = 0; j < 3; ++j) sums.gradient[i][j] = slope * sum(gradient[i][j]);
  }
}

void linear(const RbfBlock* blocks, std::size_t count, const double p[3], RbfSums& sums) noexcept {
  const double at[3] = {p[0], p[1], p[2]};
  addUp(
      blocks, count, at, 1, [](Pack squared) { return inverseSquareRoot(squared); }, sums);
}

void cubic(const RbfBlock* blocks, std::size_t count, const double p[3], RbfSums& sums) noexcept {
  const double at[3] = {p[0], p[1], p[2]};
  addUp(
      blocks, count, at, 3, [](Pack squared) { return squareRoot(squared); }, sums);
}

/// With g0 = phi, g(k+1) = g(k)' / r and d = p - centre the contribution of a centre is
///   a g0 + (b.d + tr C) g1 + (d.C d) g2,
/// because grad phi = g1 d and grad grad phi = g2 d d^T + g1 I. Its derivatives follow by the chain
/// rule.
void hermite(const HermiteBlock* blocks, std::size_t count, const double p[3],
             HermiteSums& sums) noexcept {
  Pack value{}, gradient[3] = {}, hessian[6] = {};
  for (std::size_t n = 0; n < count * rbf_lanes; n += lanes) {
    const HermiteBlock& block = blocks[n / rbf_lanes];
    const std::size_t l = n % rbf_lanes;
    const Pack d[3] = {p[0] - load(block.position[0] + l), p[1] - load(block.position[1] + l),
                       p[2] - load(block.position[2] + l)};
    const Pack b[3] = {load(block.b[0] + l), load(block.b[1] + l), load(block.b[2] + l)};
    Pack C[6];
    for (int v = 0; v < 6; ++v) C[v] = load(block.C[v] + l);
    const Pack squared = square(d);
    const Pack inverse = inverseSquareRoot(squared), r = squared * inverse;
    const Pack g3 = 105 * r, g4 = 105 * inverse;
    const Pack g2 = 35 * r * squared, g1 = 7 * r * squared * squared;

    const Pack Cd[3] = {C[0] * d[0] + C[5] * d[1] + C[4] * d[2],
                        C[5] * d[0] + C[1] * d[1] + C[3] * d[2],
                        C[4] * d[0] + C[3] * d[1] + C[2] * d[2]};
    const Pack a = load(block.a + l);
    const Pack first = b[0] * d[0] + b[1] * d[1] + b[2] * d[2] + C[0] + C[1] + C[2];
    const Pack second = d[0] * Cd[0] + d[1] * Cd[1] + d[2] * Cd[2];
    const Pack along = a * g1 + first * g2 + second * g3;
    const Pack twice = a * g2 + first * g3 + second * g4;
    value += a * (r * squared * squared * squared) + first * g1 + second * g2;
    Pack side[3];  // d along + side is the gradient; side = g1 b + 2 g2 C d
    Pack turn[3];  // d side / d p, but for what is a multiple of C: d (turn)^T + turn d^T
    for (int i = 0; i < 3; ++i) {
      side[i] = g1 * b[i] + 2 * g2 * Cd[i];
      turn[i] = g2 * b[i] + 2 * g3 * Cd[i];
      gradient[i] += along * d[i] + side[i];
    }
    const int row[6] = {0, 1, 2, 1, 0, 0}, column[6] = {0, 1, 2, 2, 2, 1};
    for (int v = 0; v < 6; ++v) {
      const int i = row[v], j = column[v];
      hessian[v] += twice * (d[i] * d[j]) + turn[i] * d[j] + d[i] * turn[j] + 2 * g2 * C[v];
      if (i == j) hessian[v] += along;
    }
  }
  sums.value = sum(value);
  for (int i = 0; i < 3; ++i) sums.gradient[i] = sum(gradient[i]);
  for (int v = 0; v < 6; ++v) sums.hessian[v] = sum(hessian[v]);
}

}  // namespace
}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
