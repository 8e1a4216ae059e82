#include "viewer/organ/touched_organ.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/mesh/anchor_bump.hpp"

namespace palpate {

TouchedOrgan::TouchedOrgan(CarriedOrgan organ)
    : organ_(std::move(organ)),
      share_fields_(organ_.spaces.size()),
      one_(organ_.shapes.mode_count),
      sum_(organ_.shapes.mode_count) {
  PALPATE_ASSERT(
      organ_.shapes.modes.size() == 3 * organ_.vertices.size() * organ_.shapes.mode_count &&
          organ_.shapes.shares.size() == organ_.spaces.size(),
      "each mode must have all vertices, and each space its weights");
  PALPATE_ASSERT(organ_.shapes.mode_count % 3 == 0,
                 "DisplacementField interpolates the shares of the modes as triples");
  for (const CarriedTouch& touch : organ_.touches) {
    PALPATE_ASSERT(!touch.spaces.empty(), "a touchable part must have a space");
    Touched& touched = touched_.emplace_back();
    if (touch.finger_radius == 0) continue;
    std::vector<const SpaceTable*> sites;
    for (const std::int32_t space : touch.spaces) sites.push_back(&organ_.spaces[at(space)]);
    touched.area.emplace(std::move(sites), AreaField::CollocationPoints{touch.collocation_points});
  }
}

Eigen::Vector3d TouchedOrgan::positionOf(const SurfacePoint& point) const {
  return combined(cornersOf(organ_.vertices, organ_.triangles[at(point.triangle)]),
                  point.barycentric);
}

bool TouchedOrgan::prepare(std::size_t touch, const Eigen::Vector3d& s) {
  Touched& touched = touched_.at(touch);
  if (touched.area) {
    if (touched.area->prepareNext(s)) return true;
    for (const std::size_t site : touched.area->sitesAt(s)) {
      const std::int32_t space = organ_.touches[touch].spaces[site];
      if (share_fields_[at(space)]) continue;
      sharesOf(space);
      return true;
    }
    return false;
  }
  if (touched.field) return false;
  const std::int32_t space = organ_.touches[touch].spaces.front();
  touched.field = std::make_unique<PotentialField>(organ_.spaces[at(space)]);
  sharesOf(space);
  return true;
}

bool TouchedOrgan::prepareAhead(std::size_t touch, const Eigen::Vector3d& s) {
  Touched& touched = touched_.at(touch);
  return touched.area && touched.area->prepareSite(s);
}

AreaSample TouchedOrgan::evaluate(std::size_t touch, const Eigen::Vector3d& s,
                                  const Eigen::Vector3d& p) const {
  const Touched& touched = touched_.at(touch);
  if (touched.area) return touched.area->evaluate(s, p);
  AreaSample sample;
  if (touched.field) static_cast<ForceSample&>(sample) = touched.field->evaluate(p);
  return sample;
}

const DisplacementField& TouchedOrgan::sharesOf(std::int32_t space) {
  auto& field = share_fields_[at(space)];
  if (!field)
    // DisplacementField interpolates any triples of numbers, so it is given the shares of the modes
    // instead of displacements.
    field = std::make_unique<DisplacementField>(organ_.spaces[at(space)],
                                                organ_.shapes.shares[at(space)]);
  return *field;
}

void TouchedOrgan::addShares(std::int32_t space, const Eigen::Vector3d& p, float weight) {
  sharesOf(space).evaluate(p, one_);
  for (std::size_t mode = 0; mode < sum_.size(); ++mode) sum_[mode] += weight * one_[mode];
}

void TouchedOrgan::shapeAt(std::size_t touch, const SurfacePoint& anchor, const Eigen::Vector3d& p,
                           std::span<float> out) {
  PALPATE_ASSERT(out.size() == 3 * organ_.vertices.size(), "a shape must move every vertex");
  std::ranges::fill(out, 0.0f);
  std::ranges::fill(sum_, 0.0f);
  const CarriedTouch& carried = organ_.touches.at(touch);
  float whole = 0;
  if (const auto& area = touched_[touch].area) {
    const Eigen::Vector3d s = positionOf(anchor);
    const double reach = area->siteReach();
    for (const std::size_t site : area->sitesAt(s)) {
      const double x = (s - area->siteCenter(site)).norm() / reach;
      const auto share = static_cast<float>(std::pow(1 - std::min(1.0, x), 2));
      addShares(carried.spaces[site], p, share);
      whole += share;
    }
  } else {
    addShares(carried.spaces.front(), p, 1);
    whole = 1;
  }
  if (whole > 0) {
    for (std::size_t mode = 0; mode < sum_.size(); ++mode) {
      const float factor = sum_[mode] / whole;
      const float* const row = organ_.shapes.modes.data() + mode * out.size();
      for (std::size_t i = 0; i < out.size(); ++i) out[i] += factor * row[i];
    }
  }
  passThroughTool(anchor, p, out);
}

void TouchedOrgan::passThroughTool(const SurfacePoint& anchor, const Eigen::Vector3d& p,
                                   std::span<float> out) {
  const Triangle& t = organ_.triangles[at(anchor.triangle)];
  double radius = 0;
  for (std::size_t c = 0; c < 3; ++c)
    radius = std::max(radius,
                      2 * (organ_.vertices[at(t[c])] - organ_.vertices[at(t[(c + 1) % 3])]).norm());
  moveAnchor(organ_.vertices, t, anchor.barycentric, positionOf(anchor), radius, p, out);
}

}  // namespace palpate
