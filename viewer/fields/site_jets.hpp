#pragma once

#include <span>

#include "common/interpolation/field_error.hpp"
#include "viewer/fields/answered_region.hpp"
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
      : energy(unit, finger_fit), drive(unit, finger_drive_fit), slope(unit, finger_slope_fit) {}
  LocalFits energy, drive, slope;
};

/// One configuration space of a finger as an area needs it: ten quantities interpolated in p, each
/// by the tensor product quintic Hermite polynomial of energy_jets.hpp, so that all are twice
/// continuously differentiable. At solved points the derivatives of E by s and p to the third order
/// are exact (but those by s alone, to the second), those with p twice or thrice where they explain
/// what is around (LocalFits::judge); higher ones are fitted.
struct SiteJets {
  /// `space` is that of a finger. Error when no point of it is solved.
  SiteJets(const SpaceTable& space, SiteFits& fits)
      : SiteJets(CellData(space, fits.energy), space, fits) {}

  /// A leaf that a lattice position is in or on. Trees of one area have the same ball.
  LeafPlace placeOf(const LatticePoint& point) const;
  SiteJet at(const LeafPlace& place) const;
  /// Whether that stands on solved points of one branch alone; else it is extrapolated.
  bool isSolvedAt(const LeafPlace& place) const;

  CellTree tree;
  AnsweredRegion region;
  std::vector<SiteJet> jets;    ///< per slot
  FieldError p_error;           ///< of the force, by interpolation in p
  std::vector<float> coverage;  ///< per slot, as ForceSample::coverage

 private:
  SiteJets(CellData data, const SpaceTable& space, SiteFits& fits);
};

/// What a leaf with these jets at the slots of its tree interpolates at a place in it.
SiteJet jetInLeaf(const CellTree& tree, std::span<const SiteJet> jets, std::int32_t leaf,
                  const Eigen::Vector3d& local);

}  // namespace palpate
