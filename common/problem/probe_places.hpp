#pragma once

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/scene/scene.hpp"

namespace palpate {

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
