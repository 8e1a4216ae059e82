#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/problem/finger.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// More are refused: the finger is too small for the surface.
inline constexpr std::size_t max_sites = 5000;

/// How far a place may be from a site of a finger of `radius` (metres), in radii: site_distance, or
/// down to 0.7 of that where forces up to max_force may press it in by more than its radius, by the
/// softest region's shear modulus at rest, without fibres. readScene has cut max_force to
/// what the device renders.
double siteDistance(const Scene& scene, double radius);

/// Sites of a finger of `radius` (metres) that cover these triangles of the mesh's surface: each is
/// the place farthest from all before it, until none is farther than `distance` radii, down to 0.6
/// of that at rims and tips, where the energy changes faster with the place. Distances are
/// straight, because the energy of a finger is a function of its position in space
/// (finger_weights.hpp): a site serves both sides of a lobe that is thin against the finger.
///
/// Left out are places where the finger would rest on `fixed` (sorted) by nearly half or more, or
/// whose triangle is fixed: their neighbours reach over them as far as they do. The number of sites
/// follows from the shape and the radius, not from the mesh, whose triangles are looked at in
/// pieces of at most place_distance. A deterministic function of the arguments. Error (bad
/// input) that says what to do when there are more than max_sites; empty when a finger can stand
/// nowhere.
std::vector<Eigen::Vector3d> sitesOn(const Mesh& mesh, const std::vector<std::int32_t>& triangles,
                                     const NodeSet& fixed, double radius, double distance);

/// Places of the surface around sites of a finger of `radius`, a place_distance of it apart: what
/// collocation points of an area are chosen from (viewer/fields/area_field.hpp). Metres.
std::vector<Eigen::Vector3d> placesAround(const Mesh& mesh,
                                          const std::vector<Eigen::Vector3d>& sites, double radius);

/// Where an area is measured: a place of its surface and a displacement there, metres.
struct ProbePlace {
  Eigen::Vector3d place = Eigen::Vector3d::Zero(), displacement = Eigen::Vector3d::Zero();
};

/// `count` random ones for a finger of `radius` metres on these triangles of the mesh's surface:
/// places evenly over the surface where a finger may stand (finger.hpp), displacements
/// evenly over directions that it is pushed to there (all of them with glued contact) and lengths
/// from a hundredth of `reach` metres to all of it. From a low-discrepancy sequence (Roberts 2018),
/// so that half of them measure the same surface more coarsely. A deterministic function of the
/// arguments; fewer, or none, where hardly a finger can stand.
std::vector<ProbePlace> probePlaces(const Mesh& mesh, const std::vector<std::int32_t>& triangles,
                                    const NodeSet& fixed, double radius, double reach,
                                    ContactMode contact, std::int32_t count);

}  // namespace palpate
