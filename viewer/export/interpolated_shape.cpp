#include "viewer/export/interpolated_shape.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/mesh/surface_point.hpp"

namespace palpate {
namespace {

void addTo(Eigen::VectorXd& sum, double factor, const std::vector<float>& values) {
  if (sum.size() == 0) sum = Eigen::VectorXd::Zero(std::ssize(values));
  PALPATE_ASSERT(sum.size() == std::ssize(values),
                 "configurations of a dataset must have the same nodes");
  sum += factor * Eigen::Map<const Eigen::VectorXf>(values.data(), sum.size()).cast<double>();
}

std::vector<float> toFloats(const Eigen::VectorXd& values) {
  std::vector<float> floats(at(values.size()));
  Eigen::Map<Eigen::VectorXf>(floats.data(), values.size()) = values.cast<float>();
  return floats;
}

}  // namespace

InterpolatedShape::InterpolatedShape(const Dataset& dataset, const ActiveChoice& choice)
    : dataset_(dataset), choice_(choice) {
  if (choice.spaces.size() > 1) surface_ = std::make_unique<TouchSurface>(dataset);
}

NodalFields InterpolatedShape::at(const std::optional<Eigen::Vector3d>& place,
                                  const Eigen::Vector3d& displacement) {
  std::map<Key, double> factors;
  for (const auto& [space, weight] : spacesAt(place)) {
    const PointBlend& blend = blends_.try_emplace(space, dataset_.spaces()[space]).first->second;
    for (const PointShare& share : blend.sharesAt(displacement))
      factors[{space, blend.points()[palpate::at(share.row)]}] += weight * share.factor;
  }
  std::erase_if(read_, [&](const auto& row) { return !factors.contains(row.first); });
  Eigen::VectorXd displacements, pressures;
  for (const auto& [key, factor] : factors) {
    const auto [row, is_new] = read_.try_emplace(key);
    if (is_new) row->second = dataset_.fields(key.first, key.second);
    addTo(displacements, factor, row->second.displacement);
    addTo(pressures, factor, row->second.pressure);
  }
  PALPATE_ASSERT(displacements.size() == 3 * std::ssize(dataset_.storedNodes()),
                 "a configuration must have values at all stored nodes");
  return {toFloats(displacements), toFloats(pressures)};
}

std::vector<std::pair<std::size_t, double>> InterpolatedShape::spacesAt(
    const std::optional<Eigen::Vector3d>& place) {
  if (!surface_) return {{choice_.spaces.front(), 1.0}};
  PALPATE_ASSERT(place.has_value(), "a touch of a surface must have a place");
  const SpaceBlend blend = surface_->blendAt(nearestOnSurface(dataset_.mesh(), *place));
  std::vector<std::pair<std::size_t, double>> spaces;
  double sum = 0;
  for (const SpaceWeight& share : blend.used()) {
    if (std::ranges::find(choice_.spaces, palpate::at(share.space)) == choice_.spaces.end())
      continue;
    spaces.emplace_back(palpate::at(share.space), share.weight);
    sum += share.weight;
  }
  // The place is outside the area, so no answer there is reliable; the nearest site gives the
  // shape.
  if (spaces.empty()) return {{nearestSite(dataset_.spaces(), choice_.spaces, *place), 1.0}};
  for (auto& [space, weight] : spaces) weight /= sum;
  return spaces;
}

}  // namespace palpate
