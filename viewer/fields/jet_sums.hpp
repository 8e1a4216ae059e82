#pragma once

#include <array>

#include "common/interpolation/energy_jets.hpp"
#include "viewer/fields/site_jets.hpp"

namespace palpate {

/// Length of the jet of one quantity, and number of its elements that are added at once.
inline constexpr std::size_t jet_numbers = SiteJet::RowsAtCompileTime, jet_lanes = 16;

/// A SiteJet in the order in which it is read: for each quantity two packs, which overlap in the
/// middle. The packs are aligned, so that each is a single cache line.
struct alignas(jet_lanes * sizeof(float)) PackedJet {
  PackedJet() = default;
  explicit PackedJet(const SiteJet& jet) noexcept;
  static constexpr std::size_t overlap = 2 * jet_lanes - jet_numbers;
  std::array<std::array<float, 2 * jet_lanes>, place_quantities> packs;
};

/// Sums of jets at the corners of a leaf, weighted by quantity. A query of an area spends much of
/// its time here. Single precision; one thread.
class JetSums {
 public:
  using Quantities = Eigen::Matrix<float, place_quantities, 1>;

  /// Clears the sums. `basis` (valueBasis) belongs to the place in the leaf at which add()
  /// evaluates the quantities.
  void begin(const LeafBasis& basis) noexcept;
  /// Adds jet * factors to the sum of each corner. Returns the quantities of these jets at the
  /// place in the leaf. Real time.
  Quantities add(const std::array<const PackedJet*, 8>& jets, const Quantities& factors) noexcept;
  /// Gives the 27 sums of each corner, divided by `divisor`, in the units of the jets.
  void divide(double divisor, std::array<EnergyJet, 8>& quotients) const noexcept;

 private:
  /// The sums of the overlapping numbers are computed twice; the second pack's copies are not read.
  using Packs = std::array<float, 2 * jet_lanes>;

  alignas(jet_lanes * sizeof(float)) std::array<Packs, 8> value_factors_, sums_;
};

}  // namespace palpate
