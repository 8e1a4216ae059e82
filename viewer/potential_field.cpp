#include "viewer/potential_field.hpp"

namespace palpate {

PotentialField::PotentialField(const CellData& data, const SpaceTable& space)
    : PotentialField(data, slotPolynomials(data.tree, space, data.inconsistent)) {}

PotentialField::PotentialField(const CellData& data, const std::vector<LocalPolynomial>& polynomials)
    : CellField(data, Limit::inconsistent),
      jets_(energyJets(data.tree, polynomials)),
      error_(data.tree, polynomials, jets_, data.suspect) {}

void PotentialField::interpolate(std::int32_t leaf, const Eigen::Vector3d& local,
                                 ForceSample& sample) const noexcept {
  const EnergySample energy = evaluateEnergy(tree(), jets_, {leaf, local});
  sample.energy = energy.energy;
  sample.force = energy.force;
  sample.stiffness = energy.stiffness;
  sample.error_bound = error_.bound(leaf, local);
}

}  // namespace palpate
