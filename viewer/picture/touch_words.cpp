#include "viewer/picture/touch_words.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "common/base/assertion.hpp"
#include "common/base/number_text.hpp"
#include "viewer/picture/lattice_dots.hpp"

namespace palpate {
namespace {

/// Names of the laws, in the order of LawName.
constexpr std::array law_names = {
    "linear elastic", "St. Venant-Kirchhoff", "modified St. Venant-Kirchhoff",
    "Mooney-Rivlin",  "neo-Hookean",          "Yeoh",
    "Ogden",          "Veronda-Westmann",     "Holzapfel-Gasser-Ogden"};
static_assert(law_names.size() == words_of<LawName>.size());

double shareOf(const Touch& touch) { return relativeError(touch.error_bound, touch.force.norm()); }

bool isBeyond(const Touch& touch) { return touch.touching && !touch.inside; }

}  // namespace

bool isUncertain(const Touch& touch) {
  return isBeyond(touch) || (touch.touching && shareOf(touch) > noticeable_force_error);
}

std::string forceText(const Eigen::Vector3d& force, const Touch& touch) {
  if (!force.allFinite() || (!touch.touching && force.norm() == 0)) return {};
  std::string text = fmt::format("{:.2f} N", force.norm());
  if (isBeyond(touch)) return text + "\ndeeper than computed: a wall pushes back";
  if (touch.touching && std::isfinite(touch.error_bound))
    text += fmt::format(" ± {:.2g} N", touch.error_bound);
  if (isUncertain(touch))
    text += fmt::format("\nuncertain: ± {:.0f} %, a hand notices {:g} %", 100 * shareOf(touch),
                        100 * noticeable_force_error);
  return text;
}

std::string untouchedText(bool one_mesh, bool one_scale) {
  if (one_mesh) return "Nothing was computed here, or the method is still being prepared.";
  return fmt::format("These datasets have different meshes, so this touch cannot be compared.{}",
                     one_scale ? "" : " (Drawn at a different scale.)");
}

std::string tissueText(const std::vector<Region>& regions) {
  PALPATE_ASSERT(!regions.empty(), "a body must have a material");
  const Material& first = regions.front().material;
  std::string text =
      fmt::format("{}, Young's modulus {:.3g} kPa",
                  law_names.at(static_cast<std::size_t>(first.law)), 1e-3 * youngModulus(first));
  const std::size_t others = regions.size() - 1;
  if (others > 0) text += ", and " + counted(others, "other material");
  return text;
}

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
