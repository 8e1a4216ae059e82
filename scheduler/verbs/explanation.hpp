#pragma once

#include <optional>

#include "common/scene/scene.hpp"
#include "common/space/space_table.hpp"
#include "proto/palpate.pb.h"

namespace palpate {

/// The spaces of a scene, in the order of the scene, with the points computed so far.
struct KnownSpaces {
  Scene scene;
  std::vector<SpaceTable> spaces;

  /// Returns the space of the active node, site or probe named `active`; with an empty name, the
  /// only space. For an area, returns the space of the site nearest to `place`, metres. Throws
  /// Error (bad input), with the valid names, if none matches. Also throws if `place` is missing
  /// for an area, or given for another tool.
  const SpaceTable& named(const std::string& active,
                          const std::optional<Eigen::Vector3d>& place = std::nullopt) const;
};

/// Reads the spaces from a dataset or a state directory. Reading a state directory takes the time
/// and memory of a scheduler's start.
KnownSpaces spacesIn(const std::string& where);

/// Explains by which chain of parents from the origin a lattice point was reached. `in_spacings`
/// gives its lattice coordinates in spacings. For a failed point, lists every failed attempt.
/// `text` holds the explanation as text for users. Throws Error (bad input), with the bounds, if
/// the point is not in the lattice.
wire::Explanation explain(const SpaceTable& space, const Eigen::Vector3d& in_spacings);

}  // namespace palpate
