#pragma once

#include <optional>

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// What is known by now of the spaces of a scene, in its order.
struct KnownSpaces {
  Scene scene;
  std::vector<SpaceTable> spaces;

  /// The space of the active node, site or probe of that name; without a name the only one there
  /// is. Of an area, the site nearest to `place`, metres. Error (bad input) that lists the names
  /// when there is no such one, and for a place without a finger or the other way round.
  const SpaceTable& named(const std::string& active,
                          const std::optional<Eigen::Vector3d>& place = std::nullopt) const;
};

/// From a dataset or a state directory. Of a directory it takes the time and memory of a start
/// there.
KnownSpaces spacesIn(const std::string& where);

/// How a lattice point of one space, given in spacings, was reached: the chain of parents back to
/// the origin; or why it was not: every attempt. `text` says it for people. Error (bad input),
/// naming the bounds, when the point is not in the lattice.
wire::Explanation explain(const SpaceTable& space, const Eigen::Vector3d& in_spacings);

}  // namespace palpate
