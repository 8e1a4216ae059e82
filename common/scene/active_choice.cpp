#include "common/scene/active_choice.hpp"

#include <algorithm>

#include "common/base/assertion.hpp"
#include "common/base/error.hpp"

namespace palpate {
namespace {

/// Returns the names that users can choose, each once, in scene order: the names of areas, and of
/// active nodes that belong to no area.
std::vector<std::string> choicesOf(const Scene& scene) {
  std::vector<std::string> names;
  for (const ActiveSelection& active : scene.active) {
    if (active.isProbe()) continue;  // probes measure an area and cannot be touched
    const std::string& name = active.area.empty() ? active.name : active.area;
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return names;
}

}  // namespace

ActiveChoice chooseActive(const Scene& scene, const std::string& name) {
  const std::vector<std::string> names = choicesOf(scene);
  PALPATE_ASSERT(!names.empty(), "a scene with probes must have another active node");
  if (name.empty() && names.size() > 1)
    throw badInput("the scene has several active nodes; choose one with --active: {}",
                   fmt::join(names, ", "));
  const std::string& chosen = name.empty() ? names.front() : name;
  for (std::size_t s = 0; s < scene.active.size(); ++s)
    if (const ActiveSelection& active = scene.active[s]; active.name == chosen && !active.isProbe())
      return {{s}, chosen, false, active.tool == ToolKind::finger};
  const std::vector<ActiveChoice> areas = areasOf(scene);
  const auto area = std::ranges::find(areas, chosen, &ActiveChoice::name);
  if (area == areas.end())
    throw badInput("--active: there is no active node \"{}\"; there are: {}", name,
                   fmt::join(names, ", "));
  return *area;
}

std::vector<ActiveChoice> areasOf(const Scene& scene) {
  std::vector<ActiveChoice> areas;
  for (std::size_t s = 0; s < scene.active.size(); ++s) {
    const std::string& name = scene.active[s].area;
    if (name.empty()) continue;
    auto area = std::ranges::find(areas, name, &ActiveChoice::name);
    if (area == areas.end()) area = areas.insert(area, {{}, name, true, true});
    area->spaces.push_back(s);
  }
  std::size_t place = 0;
  for (const ActiveSelection& active : scene.active) {
    if (!active.isProbe()) continue;
    if (const auto area = std::ranges::find(areas, active.probe_of, &ActiveChoice::name);
        area != areas.end())
      area->probe_places.push_back(place);
    ++place;
  }
  return areas;
}

void requirePlace(const ActiveChoice& choice, bool given) {
  if (choice.is_area && !given)
    throw badInput("\"{}\" is a surface that a finger touches; give the place with --at X Y Z",
                   choice.name);
  if (given && !choice.is_finger)
    throw badInput(
        "--at: \"{}\" is not a finger and cannot be moved; omit --at, or write tool = \"finger\" "
        "in the scene",
        choice.name);
}

}  // namespace palpate
