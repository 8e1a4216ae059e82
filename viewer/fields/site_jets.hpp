#pragma once

#include "common/interpolation/energy_jets.hpp"
#include "viewer/fields/hermite_kernel.hpp"

namespace palpate {

/// The 27 numbers of an EnergyJet (and one for the alignment) of each of the ten quantities of a
/// finger's energy at one place and one slot.
using SiteJet = Eigen::Matrix<float, 28, place_quantities>;

/// Fits that the sites of an area share, as long as one thread makes them. What lies beyond the
/// solved points is extrapolated by lower degrees than in a space of its own: there are many, and
/// what they say matters little beyond what the device renders.
struct SiteFits {
  explicit SiteFits(double unit)
      : energy(unit, {KnownOrders::curvature, 3, 5}),
        drive(unit, {KnownOrders::slope, 3, 4}),
        slope(unit, {KnownOrders::value, 2, 3}) {}
  LocalFits energy, drive, slope;
};

/// One configuration space of a finger as an area needs it: ten quantities interpolated in p, each
/// by the tensor product quintic Hermite polynomial of energy_jets.hpp, so that all are twice
/// continuously differentiable. Of the energy value, slope and curvature at solved points are
/// exact, of the drive T value and slope, of dT/ds the value; higher derivatives are fitted.
struct SiteJets {
  /// `space` is that of a finger. Error when no point of it is solved.
  SiteJets(const SpaceTable& space, SiteFits& fits);

  std::vector<SiteJet> jets;    ///< per slot
  std::vector<float> p_error;   ///< per slot: bound on the force's error by interpolation in p, N
  std::vector<float> coverage;  ///< per slot, as ForceSample::coverage
};

}  // namespace palpate
