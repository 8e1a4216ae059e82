#pragma once

#include "common/mesh/finger_weights.hpp"
#include "common/mesh/mesh.hpp"
#include "common/mesh/node_set.hpp"
#include "common/space/active_patch.hpp"

namespace palpate {

/// A finger rests on the body where at least this share of its bump lies on nodes that can move.
/// Beyond, the few free nodes at its rim would carry all of it.
inline constexpr double least_free_share = 0.5;

/// The weights of a finger on this body. Error (bad input), which begins with `what` ("active
/// \"tip\"") and says what to do, when it is as wide as the body, or when it rests on `fixed` by
/// more than 1 - least_free_share.
FingerWeights checkedFinger(const std::string& what, const Mesh& mesh, const NodeSet& fixed,
                            const Finger& finger);

/// The patch of a finger: the nodes and weights of checkedFinger.
ActivePatch fingerPatch(const std::string& name, const Mesh& mesh, const NodeSet& fixed,
                        const Finger& finger);

/// The finger of this radius at the point of the surface nearest to `near`, metres. Error (bad
/// input), which begins with `what`, when `near` is farther from the surface than the body is wide.
Finger fingerNear(const std::string& what, const Mesh& mesh, const Eigen::Vector3d& near,
                  double radius);

}  // namespace palpate
