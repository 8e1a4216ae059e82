#include "viewer/fields/potential_field.hpp"

#include "common/base/assertion.hpp"
#include "viewer/fields/energy_corrections.hpp"

namespace palpate {
namespace {

std::vector<LocalPolynomial> correctedPolynomials(const CellData& data, const SpaceTable& space) {
  std::vector<LocalPolynomial> polynomials = slotPolynomials(data.tree, space, data.inconsistent);
  const std::vector<double> corrections = energyCorrections(data);
  PALPATE_ASSERT(corrections.size() == polynomials.size(), "both are per slot of the same tree");
  for (std::size_t s = 0; s < polynomials.size(); ++s)
    polynomials[s].derivatives[0] += corrections[s];
  return polynomials;
}

}  // namespace

PotentialField::PotentialField(const CellData& data, const SpaceTable& space)
    : PotentialField(data, correctedPolynomials(data, space)) {}

PotentialField::PotentialField(const CellData& data,
                               const std::vector<LocalPolynomial>& polynomials)
    : CellField(data, Limit::bound),
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
