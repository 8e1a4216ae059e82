#pragma once

#include "common/scene/scene.hpp"

namespace palpate {

/// The spaces of a resolved scene that the option --active NAME selects.
struct ActiveChoice {
  std::vector<std::size_t> spaces;  ///< one space, or the sites of an area
  std::string name;                 ///< name of the active node or area
  bool is_area = false;
  bool is_finger = false;  ///< whether the tool is a finger; true for every area
  /// Indices into Dataset::probePlaces() of the probe places of an area.
  std::vector<std::size_t> probe_places = {};
};

/// Returns the active node or area with this name; if `name` is empty, the scene's only active node
/// or area. Error (bad input) that lists all names if no active node or area has this name, or if
/// the name is empty and there are several. The list contains the names of areas, but not of their
/// sites.
ActiveChoice chooseActive(const Scene& scene, const std::string& name);

/// Returns every area with its sites, in scene order.
std::vector<ActiveChoice> areasOf(const Scene& scene);

/// Error (bad input) if an area was chosen and no place was given (`--at`), or if a place was given
/// and the tool is not a finger. `given` says whether a place was given.
void requirePlace(const ActiveChoice& choice, bool given);

}  // namespace palpate
