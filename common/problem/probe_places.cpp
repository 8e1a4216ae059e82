#include "common/problem/probe_places.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/index.hpp"
#include "common/mesh/free_share.hpp"
#include "common/mesh/surface_pieces.hpp"
#include "common/mesh/surface_point.hpp"
#include "common/problem/finger.hpp"

namespace palpate {
namespace {

/// Drawn for each that is wanted, at most: a finger that only pushes takes a third of them, and may
/// stand on half of the surface.
constexpr std::int64_t most_draws = 100;
/// Of the reach: what is shorter is rest, to the lattice that probes are in.
constexpr double least_length = 0.01;

/// Element n of the sequence that fills the unit cube most evenly: multiples of the powers of 1/g,
/// where g^5 = g + 1.
Eigen::Vector4d quasiRandom(std::int64_t n) {
  constexpr double g = 1.1673039782614187;
  Eigen::Vector4d x;
  double stride = 1;
  for (double& component : x) {
    stride /= g;
    const double turns = 0.5 + static_cast<double>(n) * stride;
    component = turns - std::floor(turns);
  }
  return x;
}

/// The sphere's area is that of its cylinder (Archimedes).
Eigen::Vector3d onSphere(double height, double turn) {
  const double z = 2 * height - 1, r = std::sqrt(1 - z * z), angle = 2 * M_PI * turn;
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

std::vector<ProbePlace> probePlaces(const Mesh& mesh, const std::vector<std::int32_t>& triangles,
                                    const NodeSet& fixed, double radius, double reach,
                                    ContactMode contact, std::int32_t count) {
  std::vector<Eigen::Vector3d> middles, normals;
  std::vector<double> areas;  // of all pieces up to here, m^2
  double area = 0;
  for (const std::int32_t triangle : triangles)
    forEachPiece(mesh, triangle, place_distance * radius, [&](const SurfacePiece& piece) {
      middles.push_back(piece.middle);
      normals.push_back(normalOf(mesh, triangle));
      areas.push_back(area += piece.area);
    });
  const FreeShare free_share(mesh, fixed, radius);
  std::vector<ProbePlace> found;
  for (std::int64_t n = 1; n <= most_draws * count && std::ssize(found) < count; ++n) {
    const Eigen::Vector4d x = quasiRandom(n);
    if (x[1] < least_length) continue;
    const Eigen::Vector3d p = reach * x[1] * onSphere(x[2], x[3]);
    const auto piece = std::ranges::lower_bound(areas, x[0] * area) - areas.begin();
    const PushedPart part =
        contact == ContactMode::unilateral ? pushedAt(normals[at(piece)], radius) : PushedPart{};
    const Eigen::Vector3d& place = middles[at(piece)];
    if (part.contains(p) && !free_share.isBelow(least_free_share, place))
      found.push_back({place, p});
  }
  return found;
}

}  // namespace palpate
