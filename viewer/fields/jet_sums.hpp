#pragma once

#include <array>

#include "common/interpolation/energy_jets.hpp"
#include "viewer/fields/site_jets.hpp"

namespace palpate {

/// Length of the jet of one quantity, and number of its elements that are added at once.
inline constexpr std::size_t jet_numbers = SiteJet::RowsAtCompileTime, jet_lanes = 16;

/// Sums of SiteJets at the corners of a leaf, weighted by quantity. A query of an area spends
/// nearly all its time here. Single precision; one thread.
class JetSums {
 public:
  using Quantities = Eigen::Matrix<float, place_quantities, 1>;

  /// Clears the sums. `basis` (valueBasis) belongs to the place in the leaf at which add()
  /// evaluates the quantities.
  void begin(const LeafBasis& basis) noexcept;
  /// Adds jet * factors to the sum of each corner. Returns the quantities of these jets at the
  /// place in the leaf. Real time.
  Quantities add(const std::array<const SiteJet*, 8>& jets, const Quantities& factors) noexcept;
  /// Returns one of the 27 summed numbers of a corner, in the units of the jets.
  double sum(std::size_t corner, std::size_t number) const noexcept {
    return sums_[corner][number < jet_lanes ? number : number + overlap];
  }

 private:
  /// A jet is read as two packs of numbers that overlap in the middle, so it needs no padding. The
  /// sums of the overlapping numbers are computed twice; the second pack's copies are not read.
  static constexpr std::size_t overlap = 2 * jet_lanes - jet_numbers;
  using Packs = std::array<float, 2 * jet_lanes>;

  alignas(jet_lanes * sizeof(float)) std::array<Packs, 8> value_factors_, sums_;
};

}  // namespace palpate
