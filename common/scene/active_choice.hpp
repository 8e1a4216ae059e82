#pragma once

#include "common/scene/scene.hpp"

namespace palpate {

/// What a name after --active means in a resolved scene.
struct ActiveChoice {
  std::vector<std::size_t> spaces;  ///< one, or the sites of an area
  std::string name;                 ///< of the active node or the area
  bool is_area = false;
  bool is_finger = false;  ///< its tool; always of an area
  /// Where an area is measured (Dataset::probePlaces).
  std::vector<std::size_t> probe_places = {};
};

/// The active node or the area of this name; without a name the only one there is. Error (bad
/// input) that lists them: of an area its name and not its sites, which have names too.
ActiveChoice chooseActive(const Scene& scene, const std::string& name);

/// Every area with its sites, in the order of the scene.
std::vector<ActiveChoice> areasOf(const Scene& scene);

/// Error (bad input) when an area was chosen and no place in it, `--at`, is given, or a place of
/// what is no finger.
void requirePlace(const ActiveChoice& choice, bool given);

}  // namespace palpate
