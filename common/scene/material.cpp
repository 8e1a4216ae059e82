#include "common/scene/material.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/base/assertion.hpp"

namespace palpate {

bool isCompressible(LawName law) {
  return law == LawName::linear || law == LawName::st_venant_kirchhoff;
}

bool isMixed(const Material& material) {
  return !isCompressible(material.law) || isNearlyIncompressible(material);
}

bool isIncompressible(const Material& material) {
  return !isCompressible(material.law) && !material.bulk;
}

double shearModulus(const Material& m) {
  switch (m.law) {
    case LawName::linear:
    case LawName::st_venant_kirchhoff:
      PALPATE_ASSERT(m.poisson, "this material law needs Poisson's ratio");
      return m.young / (2 * (1 + *m.poisson));
    case LawName::modified_st_venant_kirchhoff:
      return m.poisson ? m.young / (2 * (1 + *m.poisson)) : m.young / 3;
    case LawName::mooney_rivlin: return 2 * (m.c10 + m.c01);
    case LawName::yeoh: return 2 * m.c10;
    case LawName::neo_hookean:
    case LawName::holzapfel_gasser_ogden: return m.mu;
    case LawName::ogden: {
      double twice = 0;
      for (const OgdenTerm& term : m.ogden) twice += term.mu * term.alpha;
      return twice / 2;
    }
    case LawName::veronda_westmann:
      // mu = 2 (dW/dI1 + dW/dI2) = 2 (c1 c2 - c1 c2 / 2) at rest.
      return m.c1 * m.c2;
  }
  return 0;
}

double bulkModulus(const Material& material) {
  if (isIncompressible(material)) return std::numeric_limits<double>::infinity();
  if (material.bulk) return *material.bulk;
  return material.young / (3 * (1 - 2 * *material.poisson));
}

double youngModulus(const Material& material) {
  const double shear = shearModulus(material);
  return material.bulk ? 9 * *material.bulk * shear / (3 * *material.bulk + shear)
                       : 2 * (1 + poissonRatio(material)) * shear;
}

double poissonRatio(const Material& material) {
  if (isIncompressible(material)) return 0.5;
  if (!material.bulk) return *material.poisson;
  const double bulk = *material.bulk, shear = shearModulus(material);
  return (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear));
}

std::optional<Softening> softeningOf(const Material& m) {
  if (m.law == LawName::st_venant_kirchhoff)
    return Softening{1 - 1 / std::sqrt(3.0), "compression"};
  if (m.law != LawName::yeoh || m.c20 >= 0) return std::nullopt;
  // The stress at a simple shear of g is 2 g (c10 + 2 c20 g^2 + 3 c30 g^4). It is largest at the
  // root of 15 c30 x^2 + 6 c20 x + c10 = 0 with x = g^2.
  const double discriminant = 36 * m.c20 * m.c20 - 60 * m.c30 * m.c10;
  if (discriminant < 0) return std::nullopt;
  return Softening{std::sqrt(2 * m.c10 / (-6 * m.c20 + std::sqrt(discriminant))), "shear"};
}

double contrastOf(const std::vector<Material>& materials) {
  return youngModulus(*std::ranges::max_element(materials, {}, youngModulus)) /
         shearModulus(*std::ranges::min_element(materials, {}, shearModulus));
}

bool isNearlyIncompressible(const Material& material) {
  constexpr double poisson = 0.49, bulk_over_shear = 2 * (1 + poisson) / (3 * (1 - 2 * poisson));
  if (material.bulk) return *material.bulk > bulk_over_shear * shearModulus(material);
  return !isIncompressible(material) && *material.poisson > poisson;
}

}  // namespace palpate
