#include "common/scene/material.hpp"

#include "common/base/assertion.hpp"

namespace palpate {

bool isMixed(const Material& material) {
  return material.law != LawName::linear && material.law != LawName::st_venant_kirchhoff;
}

bool isIncompressible(const Material& material) { return isMixed(material) && !material.bulk; }

double shearModulus(const Material& m) {
  switch (m.law) {
    case LawName::linear:
    case LawName::st_venant_kirchhoff:
      PALPATE_ASSERT(m.poisson, "readMaterial wants Poisson's ratio of these laws");
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
      // dW/dI1 + dW/dI2 = c1 c2 - c1 c2 / 2 at rest.
      return m.c1 * m.c2;
  }
  return 0;
}

double youngModulus(const Material& material) {
  return material.young > 0 ? material.young : 3 * shearModulus(material);
}

bool isNearlyIncompressible(const Material& material) {
  constexpr double poisson = 0.49, bulk_over_shear = 2 * (1 + poisson) / (3 * (1 - 2 * poisson));
  if (material.bulk) return *material.bulk > bulk_over_shear * shearModulus(material);
  return !isIncompressible(material) && *material.poisson > poisson;
}

}  // namespace palpate
