#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/problem/finger.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// Largest number of sites of a surface. If the surface needs more, the finger is too small, and
/// the scene is refused.
inline constexpr std::size_t max_sites = 5000;

/// Returns the largest distance from a place to its nearest site, in radii, for a finger of
/// `radius` (metres). It is site_distance if the finger is pressed in by at most 0.75 radii, falls
/// to 0.7 of this value at 1.25 radii, and stays there. The depth is estimated at max_force, with
/// the smallest shear modulus at rest of all regions, without fibres, and is at most the workspace
/// radius. readScene has already limited max_force to the largest force of the device.
double siteDistance(const Scene& scene, double radius);

/// Returns the sites of a finger of `radius` (metres) that cover these triangles of the mesh's
/// surface. Each site is the place that is farthest from all earlier sites, until no place is
/// farther than `distance` radii from its nearest site. At rims and tips the distance is reduced,
/// by up to 40 %, because the energy changes faster along the surface there. Distances are along
/// straight lines, because a finger's energy is a function of its position in space
/// (finger_weights.hpp). One site may therefore cover both sides of a thin lobe.
///
/// A place is left out if nearly half or more of the finger would rest on `fixed` (sorted), or if
/// all corners of its triangle are fixed. Such places are covered only as far as neighbouring sites
/// reach. The number of sites depends on the shape of the surface and the radius, but not on the
/// mesh, because triangles are divided into pieces of at most place_distance. The result is a
/// deterministic function of the arguments. It is empty if the finger would rest on fixed nodes
/// everywhere. Error (bad input) with a remedy if more than max_sites sites are needed.
std::vector<Eigen::Vector3d> sitesOn(const Mesh& mesh, const std::vector<std::int32_t>& triangles,
                                     const NodeSet& fixed, double radius, double distance);

/// Returns positions on the surface around `sites` of a finger of `radius`; all in metres.
/// Neighbouring positions are at most place_distance radii apart. The collocation points of an area
/// are chosen from them (viewer/fields/area_field.hpp).
std::vector<Eigen::Vector3d> placesAround(const Mesh& mesh,
                                          const std::vector<Eigen::Vector3d>& sites, double radius);

/// A place on the surface of an area and a displacement there, metres, for which an exact solution
/// measures the error of interpolation.
struct ProbePlace {
  Eigen::Vector3d place = Eigen::Vector3d::Zero(), displacement = Eigen::Vector3d::Zero();
};

/// Returns `count` quasi-random probe places for a finger of `radius` metres on these triangles of
/// the mesh's surface. Places are spread evenly over the part of the surface on which a finger may
/// stand (finger.hpp). Displacements are spread evenly over the directions that a pushing finger
/// reaches (with glued contact, over all directions) and over lengths from 1 % to 100 % of `reach`,
/// metres. Both come from a low-discrepancy sequence (Roberts 2018), so the first half of the
/// places covers the same surface more coarsely. The result is a deterministic function of the
/// arguments. It has fewer places, or none, if the finger would rest on fixed nodes nearly
/// everywhere.
std::vector<ProbePlace> probePlaces(const Mesh& mesh, const std::vector<std::int32_t>& triangles,
                                    const NodeSet& fixed, double radius, double reach,
                                    ContactMode contact, std::int32_t count);

}  // namespace palpate
