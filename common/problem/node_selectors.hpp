#pragma once

#include <string>

#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/scene/scene.hpp"

/// The places that scenes select nodes by, wherever they do.
namespace palpate {

bool isIn(const Box& box, const Eigen::Vector3d& x);
bool isIn(const Sphere& sphere, const Eigen::Vector3d& x);

/// The nodes of a physical group, mid-edge nodes too. Error (bad input) that begins with `key` when
/// there is no such group, or when it has no node.
const NodeSet& groupNamed(const Mesh& mesh, const std::string& name, const std::string& key);

}  // namespace palpate
