#pragma once

#include "common/scene/scene.hpp"

namespace palpate {

/// The spaces that a name after --active selects in a resolved scene.
struct ActiveChoice {
  std::vector<std::size_t> spaces;  ///< one space, or the sites of an area
  std::string name;                 ///< name of the active node or area
  bool is_area = false;
  bool is_finger = false;  ///< whether its tool is a finger; true for every area
  /// Indices of the probes of an area, as in Dataset::probePlaces.
  std::vector<std::size_t> probe_places = {};
};

/// Returns the active node or area of this name; an empty name selects the only one. Error (bad
/// input) with a list of all names if there is no such name or no single one. The list gives the
/// name of an area instead of its sites, which have names too.
ActiveChoice chooseActive(const Scene& scene, const std::string& name);

/// Returns every area with its sites, in scene order.
std::vector<ActiveChoice> areasOf(const Scene& scene);

/// Error (bad input) if an area was chosen without a place (`--at`), or a place was given for
/// another tool than a finger.
void requirePlace(const ActiveChoice& choice, bool given);

}  // namespace palpate
