#pragma once

#include "common/interpolation/energy_jets.hpp"
#include "common/interpolation/field_error.hpp"
#include "viewer/fields/cell_field.hpp"

namespace palpate {

/// Returns one correction per slot, J, to add to the slot's energy. The corrected energies
/// contradict the forces less where solution branches meet. Only corners of leaves with an
/// inconsistent edge have a correction other than zero. Hanging slots have zero, because they
/// follow their coarser leaf.
///
/// When the body jumps to another branch, it loses energy that the forces at the ends of the edge
/// do not account for. A conservative interpolant must release this energy within one leaf. Its
/// mean force along the edge therefore exceeds the forces at the ends by the lost energy divided by
/// the length of the edge. In the middle of a quintic polynomial, the excess is 1.9 times its mean.
/// Moving the energies at both ends towards each other spreads the excess over the leaf and its
/// neighbours along the edge.
///
/// The corrections x minimise
///
///   sum over edges of max(0, |f| - 0.1 |dF|)^2 + sum over slots of (x / h)^2,
///
/// where h is the length of the shortest edge at the slot. f, N, is the part of the energy
/// difference between the edge's ends that their forces do not explain by the corrected trapezoidal
/// rule (branch_check.hpp), divided by the length of the edge. dF is the difference between the
/// forces at the ends, projected on the edge.
std::vector<double> energyCorrections(const CellData& data);

/// Returns slotPolynomials with corrected energies. Moves the ghosts out of `data`.
std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space,
                                                  LocalFits& fits);
std::vector<LocalPolynomial> correctedPolynomials(CellData& data, const SpaceTable& space);

/// Interpolates the stored energy E(p) and differentiates it: force = -grad E, stiffness =
/// -Hessian. The force is therefore conservative by construction in the whole ball: a closed loop
/// returns no energy. The energy is defined everywhere, and the stiffness is symmetric.
///
/// In a leaf, E is the tensor product quintic Hermite polynomial of the 27 derivatives at its 8
/// corners (energy_jets.hpp). All leaves around a corner use the same derivatives, so E has
/// continuous second derivatives. Force and stiffness are continuous across faces, between leaves
/// of different size, across the rim of the solved points and around failed points.
///
/// Next to inconsistent edges (branch_check.hpp) the energies at the corners are moved towards the
/// values that the forces imply (energyCorrections). Forces and stiffnesses at solved points stay
/// as stored. The energy that a jump between branches loses is spread over about three leaves;
/// there the force belongs to neither branch.
///
/// The interpolant reproduces energies up to the fourth degree if solved points surround the leaf,
/// and up to the third degree if enough solved points are near. The error of the force is
/// proportional to the fourth power of the spacing. field_error.hpp gives the error bound. In
/// leaves with a failed corner it is larger by ten times the force and the trilinear weight of
/// these corners: the force may grow towards them faster than any solved point shows.
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
  std::vector<double> failed_;  ///< per slot: weight of corners without a usable solution
};

}  // namespace palpate
