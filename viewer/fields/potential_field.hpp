#pragma once

#include "common/interpolation/energy_jets.hpp"
#include "common/interpolation/field_error.hpp"
#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// What to add to the energy of every slot, J, so that the energies contradict the forces less
/// where branches meet; zero but at corners of leaves with an inconsistent edge. Zero for hanging
/// slots: they follow their coarser leaf.
///
/// Over a jump between branches the body loses energy that no force at the ends of the edge
/// accounts for. A conservative force has to, with energy / length of the edge more than the ends
/// say (1.9 times that in the middle of a quintic), all in one leaf. Moving the energies at both
/// ends towards each other shares that out over the leaf and those before and behind it.
///
/// With f the force, N, that an edge of length h lacks to explain the difference of the energies at
/// its ends by the corrected trapezoidal rule (branch_check.hpp), dF the difference of the forces
/// at its ends along it, and x the corrections, this minimises
///   the sum over edges of max(0, |f| - 0.1 |dF|)^2 + the sum over slots of (x / h)^2,
/// h in the second sum of the shortest edge at the slot.
std::vector<double> energyCorrections(const CellData& data);

/// slotPolynomials with the energies corrected. Takes the ghosts of `data`.
std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space,
                                                  LocalFits& fits);
std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space);

/// Interpolates the stored energy E(p) and differentiates it: force = -grad E and
/// stiffness = -Hessian. Therefore conservative by construction (a closed loop returns no energy)
/// in the whole ball, with an energy everywhere in it and a symmetric stiffness.
///
/// In a leaf E is the tensor product quintic Hermite polynomial of the 27 derivatives at its 8
/// corners (energy_jets.hpp). They belong to positions, the same for every leaf around, so E has
/// continuous second derivatives: force and stiffness are continuous over faces, between leaves of
/// different size, over the rim and around failed points.
///
/// Next to inconsistent edges (branch_check.hpp) the energies at the corners are moved towards what
/// the forces say (energyCorrections); forces and stiffnesses are the stored ones at all
/// solved points. What energy a jump between branches loses is then a ramp over some three leaves,
/// whose force is not that of either branch.
///
/// Energies up to the fourth degree are exact where solved points surround the leaf, up to the
/// third where enough are near, and the error of the force goes with the fourth power of the
/// spacing. The error bound is that of field_error.hpp.
class PotentialField : public CellField {
 public:
  /// Error when no point of the space is solved.
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
