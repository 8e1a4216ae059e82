#pragma once

#include <algorithm>

#include "common/mesh/finger_weights.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/space/active_patch.hpp"

namespace palpate {

/// A finger rests on the body where at least this share of its bump lies on nodes that can move.
/// Beyond, the few free nodes at its rim would carry all of it.
inline constexpr double least_free_share = 0.5;

/// Of the pieces that a surface is looked at in, and of placesOnSurface that collocation points of
/// an area are chosen from, in radii of the finger.
inline constexpr double place_distance = 0.1;

/// The weights of a finger on this body. Error (bad input), which begins with `what` ("active
/// \"tip\"") and says what to do, when it is as wide as the body, or when it rests on `fixed` by
/// more than 1 - least_free_share.
FingerWeights checkedFinger(const std::string& what, const Mesh& mesh, const NodeSet& fixed,
                            const Finger& finger);

/// Whether the numbers are those of a finger: finite, a radius, a direction of length one or none.
bool isFinger(const Finger& finger);

/// The patch of a finger: the nodes and weights of checkedFinger.
ActivePatch fingerPatch(const std::string& name, const Mesh& mesh, const NodeSet& fixed,
                        const Finger& finger);

/// The finger of this radius at the point of the surface nearest to `near`, metres. Error (bad
/// input), which begins with `what`, when `near` is farther from the surface than the body is wide.
Finger fingerNear(const std::string& what, const Mesh& mesh, const Eigen::Vector3d& near,
                  double radius);

/// What a finger of this radius, metres, that only pushes reaches at a place of the surface with
/// this outward unit normal: displacements that lean from the inward normal by at most 75 degrees.
/// It slides before it leans farther; the virtual hand's lean by less than 72 degrees for 99 % of
/// its time. Deeper than 1.5 radii it goes straight on: no farther aside than that.
PushedPart pushedAt(const Eigen::Vector3d& normal, double radius);

/// What it reaches at all places under the finger. The surface there turns by about the angle a
/// with cos a = 2 |m| - 1, m the mean of its unit normals by the bump of the finger; so p leans
/// from -m by at most a more than 75 degrees: all of the ball where that is half a turn, at sharp
/// rims and on thin lobes.
PushedPart pushedAround(const Mesh& mesh, const Finger& finger);
/// Whether it reaches around a lobe that is thin against it, so that normals cancel out.
bool isOnBothSides(const Mesh& mesh, const Finger& finger);

/// m: a place that is farther from the surface is not meant to lie on it. A quarter of the finger's
/// radius, or a millionth of the body's size where that is more.
inline double mostPlaceDistance(const Mesh& mesh, double finger_radius) {
  return std::max(0.25 * finger_radius, 1e-6 * boundingBox(mesh).diagonal().norm());
}

}  // namespace palpate
