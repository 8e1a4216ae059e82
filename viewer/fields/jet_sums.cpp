#include "viewer/fields/jet_sums.hpp"

#include <cstring>

#include "common/base/cpu_family.hpp"

namespace palpate {
namespace {

/// One register of AVX-512, or two of AVX2.
using JetPack = float __attribute__((vector_size(jet_lanes * sizeof(float))));

[[gnu::always_inline]] inline JetPack load(const float* numbers) {
  JetPack pack;
  std::memcpy(&pack, numbers, sizeof pack);
  return pack;
}

/// Returns sum + a * b. Machines with fused multiply-add round only once. The code for WebAssembly
/// imitates this with doubles, so a page computes the same sums as the machine that made the page.
template <class Factor>
[[gnu::always_inline]] inline JetPack addedProduct(JetPack sum, Factor a, JetPack b) {
#ifdef __wasm__
  using Wide = double __attribute__((vector_size(jet_lanes * sizeof(double))));
  const auto wide = [](JetPack pack) { return __builtin_convertvector(pack, Wide); };
  return __builtin_convertvector(wide(sum) + wide(JetPack{} + a) * wide(b), JetPack);
#else
  return sum + a * b;
#endif
}

/// Adds the jets of 8 corners to `sums`, each quantity times its entry of `factors`. Also evaluates
/// the ten quantities of these jets with the weights `value_factors`, and stores them in `values`.
/// `sums` and `value_factors` hold two packs per corner. Passes over the jets only once, because
/// none is in a cache when the tool reaches a new place.
PALPATE_PER_CPU_FAMILY void addJets(const std::array<const PackedJet*, 8>& jets,
                                    const float* factors, const float* value_factors, float* sums,
                                    float* values) noexcept {
  JetPack products[place_quantities] = {};
  for (std::size_t c = 0; c < 8; ++c) {
    const auto& packs = jets[c]->packs;
    float* const sum = sums + 2 * jet_lanes * c;
    const JetPack low_factors = load(value_factors + 2 * jet_lanes * c),
                  high_factors = load(value_factors + 2 * jet_lanes * c + jet_lanes);
    JetPack low_sum = load(sum), high_sum = load(sum + jet_lanes);
#pragma GCC unroll 10
    for (std::size_t q = 0; q < place_quantities; ++q) {
      const JetPack low = load(packs[q].data()), high = load(packs[q].data() + jet_lanes);
      low_sum = addedProduct(low_sum, factors[q], low);
      high_sum = addedProduct(high_sum, factors[q], high);
      products[q] = addedProduct(products[q], low_factors, low);
      products[q] = addedProduct(products[q], high_factors, high);
    }
    std::memcpy(sum, &low_sum, sizeof low_sum);
    std::memcpy(sum + jet_lanes, &high_sum, sizeof high_sum);
  }
  for (std::size_t q = 0; q < place_quantities; ++q) {
    values[q] = 0;
    for (std::size_t lane = 0; lane < jet_lanes; ++lane) values[q] += products[q][lane];
  }
}

/// Divides the sums of 8 corners. The loops have no branch, so that they become vector code.
PALPATE_PER_CPU_FAMILY void divideSums(const float* sums, double divisor,
                                       double* quotients) noexcept {
  for (std::size_t c = 0; c < 8; ++c) {
    const float* const low = sums + 2 * jet_lanes * c;
    const float* const high = low + PackedJet::overlap;
    double* const to = quotients + std::tuple_size_v<EnergyJet> * c;
    for (std::size_t n = 0; n < jet_lanes; ++n) to[n] = static_cast<double>(low[n]) / divisor;
    for (std::size_t n = jet_lanes; n < std::tuple_size_v<EnergyJet>; ++n)
      to[n] = static_cast<double>(high[n]) / divisor;
  }
}

}  // namespace

PackedJet::PackedJet(const SiteJet& jet) noexcept {
  for (std::size_t q = 0; q < place_quantities; ++q)
    for (std::size_t n = 0; n < packs[q].size(); ++n)
      packs[q][n] = jet(static_cast<Eigen::Index>(n < jet_lanes ? n : n - overlap),
                        static_cast<Eigen::Index>(q));
}

void JetSums::begin(const LeafBasis& basis) noexcept {
  for (std::size_t c = 0; c < basis.size(); ++c) {
    sums_[c].fill(0);
    Packs& factors = value_factors_[c];
    factors.fill(0);
    for (std::size_t n = 0; n < jet_lanes; ++n) factors[n] = static_cast<float>(basis[c][n]);
    for (std::size_t n = jet_lanes; n < basis[c].size(); ++n)
      factors[n + PackedJet::overlap] = static_cast<float>(basis[c][n]);
  }
}

void JetSums::divide(double divisor, std::array<EnergyJet, 8>& quotients) const noexcept {
  divideSums(sums_.front().data(), divisor, quotients.front().data());
}

JetSums::Quantities JetSums::add(const std::array<const PackedJet*, 8>& jets,
                                 const Quantities& factors) noexcept {
  Quantities values;
  addJets(jets, factors.data(), value_factors_.front().data(), sums_.front().data(), values.data());
  return values;
}

}  // namespace palpate
