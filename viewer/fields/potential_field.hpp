#pragma once

#include <vector>

#include "common/interpolation/energy_jets.hpp"
#include "common/interpolation/field_error.hpp"
#include "viewer/fields/cell_field.hpp"

namespace palpate {

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
/// the forces say (energy_corrections.hpp); forces and stiffnesses are the stored ones at all
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
  std::string_view name() const override { return "potential"; }

 protected:
  void interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                   ForceSample& sample) const noexcept override;

 private:
  PotentialField(const CellData& data, const SpaceTable& space);
  PotentialField(const CellData& data, const std::vector<LocalPolynomial>& polynomials);

  std::vector<EnergyJet> jets_;  ///< per slot
  FieldError error_;
};

}  // namespace palpate
