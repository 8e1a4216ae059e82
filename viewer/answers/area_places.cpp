#include "viewer/answers/area_places.hpp"

#include "common/base/index.hpp"
#include "common/problem/finger.hpp"

namespace palpate {

AreaPlaces::AreaPlaces(const Mesh& mesh, const NodeSet& fixed,
                       const std::vector<Eigen::Vector3d>& sites, double finger_radius)
    : surface_(mesh.nodes, mesh.surface),
      sites_(sites, answered_distance * finger_radius),
      free_share_(mesh, fixed, finger_radius),
      most_distance_(mostPlaceDistance(mesh, finger_radius)) {
  for (std::int32_t t = 0; at(t) < mesh.surface.size(); ++t) normals_.push_back(normalOf(mesh, t));
}

FingerPlace AreaPlaces::placeOf(const Eigen::Vector3d& near,
                                const Eigen::Vector3d& p) const noexcept {
  FingerPlace place;
  if (!near.allFinite() || !p.allFinite()) return place;
  const NearestPoint nearest = surface_.nearest(withinSquares(near));
  place.at = nearest.position;
  place.triangle = nearest.triangle;
  place.distance = (near - place.at).stableNorm();
  place.fault = faultOf(place);
  return place;
}

FingerPlace::Fault AreaPlaces::faultOf(const FingerPlace& place) const noexcept {
  using Fault = FingerPlace::Fault;
  if (!(place.distance <= most_distance_)) return Fault::away;
  if (!sites_.isReached(place.at)) return Fault::no_site;
  return free_share_.isBelow(least_free_share, place.at) ? Fault::fixed : Fault::none;
}

ForceAnswer AreaPlaces::answer(const AreaField& area, const Eigen::Vector3d& near,
                               const Eigen::Vector3d& p) const noexcept {
  FingerPlace place = placeOf(near, p);
  if (place.triangle < 0) return {{}, place};
  const AreaSample sample = area.evaluate(place.at, p);
  const Eigen::Vector3d& normal = normals_[at(place.triangle)];
  place.drive = sample.drive - normal.dot(sample.drive) * normal;
  ForceAnswer answer{sample, place};
  answer.sample.inside = sample.inside && place.fault == FingerPlace::Fault::none;
  return answer;
}

}  // namespace palpate
