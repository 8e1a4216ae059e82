#include "viewer/picture/pressure_words.hpp"

#include <fmt/format.h>

namespace palpate {

std::string whyNoPressures(const SurfacePressures& pressures) {
  if (pressures.isPrepared()) return {};
  switch (pressures.source()) {
    case PressureSource::stored: break;
    case PressureSource::material:
      return "There are no pressures: linear and St. Venant-Kirchhoff materials have none.";
    case PressureSource::formulation:
      return "There are no pressures: the scene says pressure = \"none\" in [discretization]. "
             "Leave it out, and say displacement = \"all\" in [storage].";
    case PressureSource::storage:
      return "The pressures were not stored: say displacement = \"all\" in [storage] of the "
             "scene, and build again, which computes nothing anew.";
  }
  return fmt::format("preparing pressures: {:.0f} %", 100 * pressures.preparedShare());
}

}  // namespace palpate
