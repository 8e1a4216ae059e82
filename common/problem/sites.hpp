#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/problem/finger.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

/// Largest number of sites; a surface that needs more is refused, because the finger is too small.
inline constexpr std::size_t max_sites = 5000;

/// Returns the largest distance from a place to a site of a finger of `radius` (metres), in radii.
/// It is site_distance, and falls to 0.7 of that if forces up to max_force may press the finger in
/// by more than its radius. The softest region's shear modulus at rest, without fibres, decides.
/// readScene has already cut max_force to the device's range.
double siteDistance(const Scene& scene, double radius);

/// Returns the sites of a finger of `radius` (metres) that cover these triangles of the mesh's
/// surface. Each site is the place farthest from all earlier ones, until none is farther than
/// `distance` radii. That limit falls to 0.6 of it at rims and tips, where the energy changes
/// faster along the surface. Distances are straight lines, because a finger's energy is a function
/// of its position in space (finger_weights.hpp). One site therefore serves both sides of a thin
/// lobe.
///
/// Places are left out if the finger would rest on `fixed` (sorted) by nearly half or more, or if
/// their triangle is fixed. Neighbouring sites extend over them as far as they reach. The number of
/// sites depends on shape and radius, but not on the mesh, because triangles are divided into
/// pieces of at most place_distance. The result is a deterministic function of the arguments; it is
/// empty if a finger can stand nowhere. Error (bad input) with a remedy if there are more than
/// max_sites.
std::vector<Eigen::Vector3d> sitesOn(const Mesh& mesh, const std::vector<std::int32_t>& triangles,
                                     const NodeSet& fixed, double radius, double distance);

/// Returns places of the surface around `sites` of a finger of `radius`, at most place_distance
/// radii apart, in metres. The collocation points of an area are chosen from them
/// (viewer/fields/area_field.hpp).
std::vector<Eigen::Vector3d> placesAround(const Mesh& mesh,
                                          const std::vector<Eigen::Vector3d>& sites, double radius);

/// A place on the surface of an area and a displacement there, metres, at which interpolation is
/// measured.
struct ProbePlace {
  Eigen::Vector3d place = Eigen::Vector3d::Zero(), displacement = Eigen::Vector3d::Zero();
};

/// Returns `count` quasi-random probe places for a finger of `radius` metres on these triangles of
/// the mesh's surface. Places are spread evenly over the surface on which a finger may stand
/// (finger.hpp). Displacements are spread evenly over the directions that pushing reaches (all
/// directions with glued contact) and over lengths from 1 % to 100 % of `reach` metres. They come
/// from a low-discrepancy sequence (Roberts 2018), so the first half covers the same surface more
/// coarsely. The result is a deterministic function of the arguments, with fewer places, or none,
/// if a finger can hardly stand there.
std::vector<ProbePlace> probePlaces(const Mesh& mesh, const std::vector<std::int32_t>& triangles,
                                    const NodeSet& fixed, double radius, double reach,
                                    ContactMode contact, std::int32_t count);

}  // namespace palpate
