#pragma once

#include <algorithm>

#include "common/mesh/finger_weights.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/space/active_patch.hpp"

namespace palpate {

/// Smallest allowed share of a finger's bump (FingerWeights::free_share) on movable nodes. With a
/// smaller share, a few free nodes at the rim of the finger would carry all the force.
inline constexpr double least_free_share = 0.5;

/// Largest edge, in finger radii, of the pieces into which the surface is divided to choose sites.
/// It is also the spacing of the candidates for collocation points of an area (placesAround in
/// sites.hpp).
inline constexpr double place_distance = 0.1;

/// Returns the weights of a finger on this body. Error (bad input) if the finger is as wide as the
/// body, or if its free share is below least_free_share. The message begins with `what` ("active
/// \"tip\"") and suggests a change of the scene. derivatives: as in fingerWeights().
FingerWeights checkedFinger(const std::string& what, const Mesh& mesh, const NodeSet& fixed,
                            const Finger& finger, bool derivatives = true);

/// Returns whether the numbers of a finger are valid: finite centre, positive radius, `outward` of
/// length 1 or 0, `pull` and `width` in their ranges (PushedPart).
bool isFinger(const Finger& finger);

/// Makes the patch of a finger from the nodes and weights of checkedFinger.
ActivePatch fingerPatch(const std::string& name, const Mesh& mesh, const NodeSet& fixed,
                        const Finger& finger);

/// Returns the finger of this radius at the surface point nearest to `near`, metres. Error (bad
/// input) if `near` is farther from the surface than the body is wide. The message begins with
/// `what`.
Finger fingerNear(const std::string& what, const Mesh& mesh, const Eigen::Vector3d& near,
                  double radius);

/// Returns the displacements that a finger of this radius (metres), which can only push, reaches at
/// a place with this outward unit normal. They make an angle of at most 75 degrees with the inward
/// normal, because the finger slides at larger angles. (The displacements of the virtual hand stay
/// below 72 degrees for 99 % of its time.) Their component along the surface is at most 1.5 radii,
/// however deep the finger is pressed in.
PushedPart pushedAt(const Eigen::Vector3d& normal, double radius);

/// Returns the displacements p that a finger, which can only push, reaches at any of the places
/// under `finger`. Let m be the mean of the unit normals there, weighted by the finger's bump. The
/// surface turns by about the angle a with cos a = 2 |m| - 1, so the angle between p and -m is at
/// most 75 degrees plus a. If this is 180 degrees or more, as at sharp rims and on thin lobes,
/// returns the whole ball.
PushedPart pushedAround(const Mesh& mesh, const Finger& finger);
/// Returns whether the finger covers both sides of a lobe that is thinner than the finger, so that
/// the normals under the finger nearly cancel out.
bool isOnBothSides(const Mesh& mesh, const Finger& finger);

/// Returns the largest distance from the surface, m, at which a place still counts as on the
/// surface. It is a quarter of the finger's radius, or a millionth of the body's size if that is
/// more.
inline double mostPlaceDistance(const Mesh& mesh, double finger_radius) {
  return std::max(0.25 * finger_radius, 1e-6 * boundingBox(mesh).diagonal().norm());
}

}  // namespace palpate
