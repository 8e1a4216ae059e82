#include "viewer/haptics/guessed_sites.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/index.hpp"
#include "common/mesh/bump_integrals.hpp"

namespace palpate {
namespace {

/// Stiffness of a finger on a body, divided by Young's modulus and the finger's radius. It is lower
/// than that of a half-space, because organs are thin and give way as a whole.
constexpr double stiffness_share = 0.5;
/// Distance from the finger, in its radii, at which the guessed shape ends.
constexpr double shape_radii = 3;

}  // namespace

bool isUnfinished(const SpaceTable& space) {
  return std::ranges::any_of(space.points,
                             [](const PointRecord& point) { return point.tag == Tag::unknown; });
}

void guess(SpaceTable& site, const Scene& scene) {
  PALPATE_ASSERT(site.patch.finger, "only the force of a finger can be guessed");
  const auto modulusOf = [](const Region& region) { return youngModulus(region.material); };
  const double softest = std::ranges::min(mapped(scene.regions, modulusOf));
  const double spring = stiffness_share * softest * site.patch.finger->radius;
  for (std::size_t n = 0; n < site.points.size(); ++n) {
    const Eigen::Vector3d p = site.lattice.displacement(static_cast<std::int32_t>(n));
    PointRecord& point = site.points[n] = {};
    point.tag = Tag::expandable;
    point.equilibrium.energy = 0.5 * spring * p.squaredNorm();
    point.equilibrium.force = -spring * p;
    point.equilibrium.stiffness = -spring * Eigen::Matrix3d::Identity();
  }
}

std::vector<float> guessedShapes(const SpaceTable& site,
                                 std::span<const Eigen::Vector3d> vertices) {
  const Finger& finger = *site.patch.finger;
  std::vector<float> displacements;
  for (std::size_t n = 0; n < site.points.size(); ++n) {
    const Eigen::Vector3d p = site.lattice.displacement(static_cast<std::int32_t>(n));
    for (const Eigen::Vector3d& vertex : vertices) {
      const double share = bumpAt(vertex, finger.center, shape_radii * finger.radius);
      for (const double component : p)
        displacements.push_back(static_cast<float>(share * component));
    }
  }
  return displacements;
}

}  // namespace palpate
