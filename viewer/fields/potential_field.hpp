#pragma once

#include "common/interpolation/energy_jets.hpp"
#include "common/interpolation/field_error.hpp"
#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// Returns corrections to add to the energies of the slots, J, so that they contradict the forces
/// less where branches meet. They are zero except at corners of leaves with an inconsistent edge,
/// and zero for hanging slots, which follow their coarser leaf.
///
/// Over a jump between branches the body loses energy that the forces at the ends of the edge do
/// not account for. A conservative force must account for it within one leaf. It exceeds the forces
/// at the ends by this energy over the length of the edge, and by 1.9 times as much in the middle
/// of a quintic. Moving the energies at both ends towards each other spreads this over the leaf and
/// its neighbours along the edge.
///
/// The corrections x minimise
///
///   the sum over edges of max(0, |f| - 0.1 |dF|)^2 + the sum over slots of (x / h)^2,
///
/// where h is the length of the edge, in the second sum of the shortest edge at the slot. f is the
/// force, N, that the edge lacks to explain the energy difference of its ends by the corrected
/// trapezoidal rule (branch_check.hpp). dF is the difference of the forces at its ends, along it.
std::vector<double> energyCorrections(const CellData& data);

/// Returns slotPolynomials with corrected energies. Consumes the ghosts of `data`.
std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space,
                                                  LocalFits& fits);
std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space);

/// Interpolates the stored energy E(p) and differentiates it: force = -grad E, stiffness =
/// -Hessian. So it is conservative by construction in the whole ball (a closed loop returns no
/// energy), with an energy everywhere and a symmetric stiffness.
///
/// In a leaf, E is the tensor product quintic Hermite polynomial of the 27 derivatives at its 8
/// corners (energy_jets.hpp). The derivatives belong to positions, the same for every leaf around
/// one, so E has continuous second derivatives. Force and stiffness are continuous across faces,
/// between leaves of different size, across the rim and around failed points.
///
/// Next to inconsistent edges (branch_check.hpp) the energies at the corners are moved towards the
/// values that the forces imply (energyCorrections). Forces and stiffnesses stay the stored ones at
/// all solved points. The energy lost in a jump between branches becomes a ramp over some three
/// leaves, where the force belongs to neither branch.
///
/// Energies up to the fourth degree are exact where solved points surround the leaf, and up to the
/// third where enough are near. The error of the force is proportional to the fourth power of the
/// spacing. field_error.hpp gives the error bound.
class PotentialField : public CellField {
 public:
  /// Error if no point of the space is solved.
  explicit PotentialField(const SpaceTable& space) : PotentialField(CellData(space), space) {}

 protected:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

 private:
  PotentialField(CellData data, const SpaceTable& space);
  PotentialField(const CellData& data, const std::vector<LocalPolynomial>& polynomials);

  std::vector<EnergyJet> jets_;  ///< per slot
  FieldError error_;
};

}  // namespace palpate
