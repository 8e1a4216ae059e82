#include "viewer/export/point_blend.hpp"

#include <map>

#include "viewer/fields/slot_terms.hpp"

namespace palpate {

PointBlend::PointBlend(const SpaceTable& space) : PointBlend(CellBranches(space)) {}

PointBlend::PointBlend(const CellBranches& data) : tree_(data.tree) {
  for (const std::vector<SlotTerm>& terms : solvedTerms(data)) {
    std::vector<PointShare>& shares = shares_.emplace_back();
    for (const SlotTerm& term : terms)
      shares.push_back({tree_.slots()[at(term.slot)].number, term.factor});
  }
}

std::vector<PointShare> PointBlend::sharesAt(const Eigen::Vector3d& displacement) const {
  LeafPlace place = tree_.find(displacement);
  if (place.leaf < 0) place = tree_.find(nearestInBall(displacement, tree_.radius()));
  PALPATE_ASSERT(place.leaf >= 0, "the leaves contain the whole ball");
  const std::array<double, 8> weights = trilinearWeights(place.local);
  std::map<std::int32_t, double> factors;
  for (std::size_t c = 0; c < 8; ++c) {
    if (weights[c] == 0) continue;
    for (const PointShare& share : shares_[at(tree_.corners(place.leaf)[c])])
      factors[share.point] += weights[c] * share.factor;
  }
  std::vector<PointShare> shares;
  for (const auto& [point, factor] : factors) shares.push_back({point, factor});
  return shares;
}

}  // namespace palpate
