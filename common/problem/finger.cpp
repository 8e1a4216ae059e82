#include "common/problem/finger.hpp"

#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"
#include "common/mesh/surface_pieces.hpp"
#include "common/mesh/surface_point.hpp"

namespace palpate {
namespace {

/// If the mean of the unit normals under a finger is shorter than this, the finger covers both
/// sides of a lobe. A surface that turns by a right angle gives a length of 0.5.
constexpr double both_sides = 0.35;

/// Cosine and sine of 75 degrees, the largest angle between the displacement of a pushing finger
/// and the inward normal.
constexpr double lean_cosine = 0.25881904510252074, lean_sine = 0.9659258262890683;

/// Largest component along the surface of a displacement that pushing reaches, in finger radii.
/// Deep displacements into soft parts go inward rather than sideways.
constexpr double pushed_width = 1.5;

/// Returns the mean of the unit normals under the finger, weighted by the finger's bump.
Eigen::Vector3d meanNormal(const Mesh& mesh, const Finger& finger) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double whole = 0;
  for (std::int32_t t = 0; static_cast<std::size_t>(t) < mesh.surface.size(); ++t) {
    if (!boxOf(mesh, t).intersects(boxAround(finger.center, finger.radius))) continue;
    const Eigen::Vector3d normal = normalOf(mesh, t);
    forEachPiece(mesh, t, place_distance * finger.radius, [&](const SurfacePiece& piece) {
      const double bump = bumpAt(piece.middle, finger.center, finger.radius) * piece.area;
      whole += bump;
      sum += bump * normal;
    });
  }
  return whole > 0 ? Eigen::Vector3d(sum / whole) : sum;
}

}  // namespace

FingerWeights checkedFinger(const std::string& what, const Mesh& mesh, const NodeSet& fixed,
                            const Finger& finger, bool derivatives) {
  const double diagonal = boundingBox(mesh).diagonal().norm();
  if (!(2 * finger.radius < diagonal))
    throw badInput(
        "{}: a finger of radius {:.4g} m is as wide as the body, whose diagonal is {:.4g} m; "
        "make radius smaller, or use tool = \"rigid\"",
        what, finger.radius, diagonal);
  FingerWeights weights = fingerWeights(mesh, fixed, finger.center, finger.radius, derivatives);
  if (!(weights.free_share >= least_free_share))
    throw badInput(
        "{}: the finger at {} (radius {:.4g} m) has {:.0f} % of its contact area on fixed nodes "
        "and would not feel the tissue; move it away, make radius smaller, or fix fewer nodes",
        what, placeText(finger.center), finger.radius, 100 * (1 - weights.free_share));
  return weights;
}

bool isFinger(const Finger& finger) {
  const PushedPart& reach = finger.reach;
  const double length = reach.outward.norm();
  return finger.center.allFinite() && finger.radius > 0 &&
         (length == 0 || std::abs(length - 1) < 1e-12) && reach.pull >= -1 && reach.pull <= 1 &&
         reach.width > 0;
}

ActivePatch fingerPatch(const std::string& name, const Mesh& mesh, const NodeSet& fixed,
                        const Finger& finger) {
  FingerWeights weights =
      checkedFinger(fmt::format("active \"{}\"", name), mesh, fixed, finger, /*derivatives=*/false);
  PALPATE_ASSERT(!weights.nodes.empty() && weights.nodes.size() == weights.weights.size(),
                 "a finger must have a weight for each of its nodes");
  ActivePatch patch;
  patch.name = name;
  NodeSet vertices = weights.nodes;
  std::erase_if(vertices, [&](std::int32_t node) { return node >= mesh.vertices(); });
  if (vertices.empty())
    throw badInput(
        "active \"{}\": all vertices under the finger of radius {:.4g} m at {} are fixed; move it",
        name, finger.radius, placeText(finger.center));
  patch.node = *std::ranges::min_element(vertices, {}, [&](std::int32_t node) {
    return (mesh.nodes[node] - finger.center).squaredNorm();
  });
  patch.nodes = std::move(weights.nodes);
  patch.weights = std::move(weights.weights);
  patch.finger = finger;
  return patch;
}

PushedPart pushedAt(const Eigen::Vector3d& normal, double radius) {
  return {normal, -lean_cosine, pushed_width * radius};
}

PushedPart pushedAround(const Mesh& mesh, const Finger& finger) {
  const Eigen::Vector3d mean = meanNormal(mesh, finger);
  const double length = mean.norm();
  // This is cos a, with the angle a of finger.hpp.
  const double cosine = std::clamp(2 * length - 1, -1.0, 1.0);
  const double sine = std::sqrt(1 - cosine * cosine);
  if (!(sine * lean_cosine + cosine * lean_sine > 0)) return {};
  return {mean / length, sine * lean_sine - cosine * lean_cosine, pushed_width * finger.radius};
}

bool isOnBothSides(const Mesh& mesh, const Finger& finger) {
  return meanNormal(mesh, finger).norm() < both_sides;
}

Finger fingerNear(const std::string& what, const Mesh& mesh, const Eigen::Vector3d& near,
                  double radius) {
  Finger finger = {positionOf(mesh, nearestOnSurface(mesh, near)), radius};
  const double distance = (finger.center - near).norm();
  if (distance > boundingBox(mesh).diagonal().norm())
    throw badInput(
        "{}: {} is {:.4g} m away from the surface, more than the body is wide; is the unit right?",
        what, placeText(near), distance);
  return finger;
}

}  // namespace palpate
