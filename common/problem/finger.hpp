#pragma once

#include <algorithm>

#include "common/mesh/finger_weights.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/space/active_patch.hpp"

namespace palpate {

/// Smallest share of a finger's bump that must lie on movable nodes. With less, the few free nodes
/// at its rim would carry all the force.
inline constexpr double least_free_share = 0.5;

/// Spacing in finger radii of the pieces that the surface is divided into, and of the candidates
/// for collocation points of an area (placesAround in sites.hpp).
inline constexpr double place_distance = 0.1;

/// Returns the weights of a finger on this body. Error (bad input) if the finger is as wide as the
/// body or rests on `fixed` by more than 1 - least_free_share. The message begins with `what`
/// ("active \"tip\"") and says what to change.
FingerWeights checkedFinger(const std::string& what, const Mesh& mesh, const NodeSet& fixed,
                            const Finger& finger);

/// Returns whether the numbers are valid: finite centre, positive radius, `outward` of length 1 or
/// 0, pull and width in their ranges.
bool isFinger(const Finger& finger);

/// Makes the patch of a finger from the nodes and weights of checkedFinger.
ActivePatch fingerPatch(const std::string& name, const Mesh& mesh, const NodeSet& fixed,
                        const Finger& finger);

/// Returns the finger of this radius at the surface point nearest to `near`, metres. Error (bad
/// input), beginning with `what`, if `near` is farther from the surface than the body is wide.
Finger fingerNear(const std::string& what, const Mesh& mesh, const Eigen::Vector3d& near,
                  double radius);

/// Returns the displacements that a purely pushing finger of this radius (metres) reaches at a
/// place with this outward unit normal. They lean from the inward normal by at most 75 degrees,
/// because the finger slides before it leans farther. The displacements of the virtual hand lean by
/// less than 72 degrees for 99 % of its time. The displacements go at most 1.5 radii aside, so
/// deeper ones go straight on.
PushedPart pushedAt(const Eigen::Vector3d& normal, double radius);

/// Returns the displacements that it reaches at any place under the finger. Let m be the mean of
/// the unit normals there, weighted by the finger's bump. The surface turns by about the angle a
/// with cos a = 2 |m| - 1. So p leans from -m by at most 75 degrees plus a. The whole ball is
/// returned if that is 180 degrees or more, as at sharp rims and on thin lobes.
PushedPart pushedAround(const Mesh& mesh, const Finger& finger);
/// Returns whether the finger reaches around a lobe thinner than itself, so that normals cancel
/// out.
bool isOnBothSides(const Mesh& mesh, const Finger& finger);

/// Returns the largest distance from the surface, m, of a place that is meant to lie on it. It is a
/// quarter of the finger's radius, or a millionth of the body's size if that is more.
inline double mostPlaceDistance(const Mesh& mesh, double finger_radius) {
  return std::max(0.25 * finger_radius, 1e-6 * boundingBox(mesh).diagonal().norm());
}

}  // namespace palpate
