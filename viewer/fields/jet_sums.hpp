#pragma once

#include <array>

#include "common/interpolation/energy_jets.hpp"
#include "viewer/fields/site_jets.hpp"

namespace palpate {

/// Numbers of one quantity's jet, and how many of them are added at once.
inline constexpr std::size_t jet_numbers = SiteJet::RowsAtCompileTime, jet_lanes = 16;

/// Weighted sums of SiteJets over their quantities, at the corners of a leaf. A query of an area
/// spends nearly all its time here. Single precision; one thread.
class JetSums {
 public:
  using Quantities = Eigen::Matrix<float, place_quantities, 1>;

  /// Clears the sums. `basis` (valueBasis) determines the place in the leaf for the values of
  /// add().
  void begin(const LeafBasis& basis) noexcept;
  /// Adds jet * factors at each corner. Returns the values of the quantities at the place. Real
  /// time.
  Quantities add(const std::array<const SiteJet*, 8>& jets, const Quantities& factors) noexcept;
  /// Returns one of the 27 summed numbers of a corner, in the units of the jets.
  double sum(std::size_t corner, std::size_t number) const noexcept {
    return sums_[corner][number < jet_lanes ? number : number + overlap];
  }

 private:
  /// The numbers are stored in two packs that overlap in the middle. The second pack's overlapping
  /// sums are computed too, but not read, so jets need no padding.
  static constexpr std::size_t overlap = 2 * jet_lanes - jet_numbers;
  using Packs = std::array<float, 2 * jet_lanes>;

  alignas(jet_lanes * sizeof(float)) std::array<Packs, 8> value_factors_, sums_;
};

}  // namespace palpate
