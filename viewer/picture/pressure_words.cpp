#include "viewer/picture/pressure_words.hpp"

#include <fmt/format.h>

namespace palpate {

std::string whyNoPressures(const SurfacePressures& pressures) {
  if (pressures.isPrepared()) return {};
  switch (pressures.source()) {
    case PressureSource::stored: break;
    case PressureSource::material:
      return "No pressures: linear and St. Venant-Kirchhoff materials have none.";
    case PressureSource::formulation:
      return "No pressures: the scene has pressure = \"none\" in [discretization]. Remove it, "
             "and set displacement = \"all\" in [storage].";
    case PressureSource::storage:
      return "No pressures stored: set displacement = \"all\" in [storage], which stores them too, "
             "and build again (nothing is solved again).";
  }
  return fmt::format("preparing pressures: {:.0f} %", 100 * pressures.preparedShare());
}

}  // namespace palpate
