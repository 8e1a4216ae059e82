#pragma once

#include <span>
#include <string>
#include <string_view>

namespace palpate::simulation {

/// A defect that can be planted in the service (plant.py), to show that the simulation finds it.
struct Defect {
  std::string_view name, what;
};
/// None in the program that has the service as it is.
std::span<const Defect> plantedDefects();
/// Which of them is there from now on; empty: none.
void plant(const std::string& name);

}  // namespace palpate::simulation
