#pragma once

#include <span>
#include <string>
#include <string_view>

namespace palpate::simulation {

/// A defect that plant.py can plant in the service, to show that the simulation finds it.
struct Defect {
  std::string_view name, what;
};
/// Returns all planted defects; the program with the unchanged service has none.
std::span<const Defect> plantedDefects();
/// Activates one of the defects from now on, or none if `name` is empty.
void plant(const std::string& name);

}  // namespace palpate::simulation
