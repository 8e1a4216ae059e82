#pragma once

#include <array>

#include "common/interpolation/energy_jets.hpp"
#include "viewer/fields/site_jets.hpp"

namespace palpate {

/// Numbers of a jet of one quantity, and how many of them are added at once.
inline constexpr std::size_t jet_numbers = SiteJet::RowsAtCompileTime, jet_lanes = 16;

/// Sums of SiteJets over their quantities at the corners of one leaf: nearly all the time of a
/// query of an area goes in here. In single precision; one thread.
class JetSums {
 public:
  using Quantities = Eigen::Matrix<float, place_quantities, 1>;

  /// Nothing is summed yet; `basis` (valueBasis) says where in the leaf values are wanted.
  void begin(const LeafBasis& basis) noexcept;
  /// Adds jet * factors at each corner. Returns the values that the quantities have. Real time.
  Quantities add(const std::array<const SiteJet*, 8>& jets, const Quantities& factors) noexcept;
  /// What has been summed at a corner: of the 27 numbers, in the units of the jets.
  double sum(std::size_t corner, std::size_t number) const noexcept {
    return sums_[corner][number < jet_lanes ? number : number + overlap];
  }

 private:
  /// The numbers are in two packs, whose middle ones are the same; those of the second pack are
  /// added too, and not looked at. So jets need no room between them.
  static constexpr std::size_t overlap = 2 * jet_lanes - jet_numbers;
  using Packs = std::array<float, 2 * jet_lanes>;

  alignas(jet_lanes * sizeof(float)) std::array<Packs, 8> value_factors_, sums_;
};

}  // namespace palpate
