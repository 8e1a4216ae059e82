#pragma once

#include <span>

#include "common/interpolation/field_error.hpp"
#include "viewer/fields/answered_region.hpp"
#include "viewer/fields/hermite_kernel.hpp"

namespace palpate {

/// The 27 numbers of an EnergyJet (and one for alignment) for each of the ten quantities of a
/// finger's energy, at one place and one slot.
using SiteJet = Eigen::Matrix<float, 28, place_quantities>;
/// The same numbers of one quantity.
using QuantityJet = Eigen::Matrix<float, SiteJet::RowsAtCompileTime, 1>;

/// Local fits that one thread shares between all sites that it prepares. Beyond the solved points
/// they extrapolate with polynomials of lower degree than the fits for a single space. This saves
/// time, because an area has many sites. It costs little accuracy, because extrapolated values
/// mostly belong to larger forces than the device renders.
struct SiteFits {
  explicit SiteFits(double unit)
      : energy(unit, finger_fit), drive(unit, finger_drive_fit), slope(unit, finger_slope_fit) {}
  LocalFits energy, drive, slope;
};

/// The configuration space of a finger at one site, prepared for an area. Each of the ten
/// quantities is interpolated in p by the tensor product quintic Hermite polynomial of
/// energy_jets.hpp, so all are twice continuously differentiable. At solved points the derivatives
/// of E with respect to s and p are exact to the third order, and those with respect to s alone to
/// the second. Second and third derivatives with respect to p are exact only if they agree with the
/// data of the points around (LocalFits::judge). Higher derivatives are fitted.
struct SiteJets {
  /// `space`: the space of a finger. Error if none of its points is solved.
  SiteJets(const SpaceTable& space, SiteFits& fits)
      : SiteJets(CellData(space, fits.energy), space, fits) {}

  /// Returns a leaf that contains a lattice position, in its interior or on its boundary. The
  /// position may come from the tree of another site of the area, because all have the same ball.
  LeafPlace placeOf(const LatticePoint& point) const;
  SiteJet at(const LeafPlace& place) const;

  CellTree tree;
  AnsweredRegion region;
  std::vector<SiteJet> jets;    ///< per slot
  FieldError p_error;           ///< error of the force by interpolation in p
  std::vector<float> coverage;  ///< per slot, as ForceSample::coverage

 private:
  SiteJets(CellData data, const SpaceTable& space, SiteFits& fits);
};

/// Interpolates jets in a leaf. `jets`: one per slot of the tree.
SiteJet jetInLeaf(const CellTree& tree, std::span<const SiteJet> jets, std::int32_t leaf,
                  const Eigen::Vector3d& local);

}  // namespace palpate
