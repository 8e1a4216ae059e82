#pragma once

#include "worker/elements/element_kernels.hpp"
#include "worker/laws/laws.hpp"

/// The response of a material to a deformation, at one point of each element of a batch. Every
/// translation unit that compiles kernels gets its own copy, in its own namespace.
namespace palpate::PALPATE_KERNEL_NAMESPACE {

#define PALPATE_INLINE inline __attribute__((always_inline))

using Tensor = Pack[3][3];
using Voigt = Pack[6];  ///< a symmetric tensor in Voigt order (strain.hpp)

struct Deformation {
  /// Deformation gradient. It is the identity for the small-strain law, because the stress of that
  /// law does not rotate with the body.
  Tensor F;
  Strain<Pack> strain;
};

/// A function g(J), J = det F, and its derivatives g' = J dg/dJ and g'' with respect to ln J.
struct VolumeFunction {
  Pack value, first, second;
};

struct Response {
  Pack energy;                ///< energy per rest volume, with its volumetric part, Pa
  Voigt S;                    ///< second Piola-Kirchhoff stress, Pa
  Pack D[6][6];               ///< dS/dgamma, Pa; set only if the tangent is computed
  VolumeFunction constraint;  ///< c(J); set only if the material has a pressure
};

PALPATE_INLINE VolumeFunction constraintOf(Constraint constraint, Pack J) {
  if (constraint == Constraint::det_F_minus_1) return {J - 1.0, J, J};
  return {lanewise(J, [](double lane) { return __builtin_log(lane); }), Pack{} + 1.0, Pack{}};
}

PALPATE_INLINE VolumeFunction penaltyOf(double bulk, Pack J) {
  const auto [U, dU, ddU] = volumetricEnergy(bulk, J);
  // The logarithm makes U NaN for an inverted element. Adding 0 * U makes its forces NaN too.
  const Pack nothing = 0.0 * U;
  return {U, J * dU + nothing, J * dU + J * J * ddU};
}

PALPATE_INLINE void invertC(Strain<Pack>& strain) {
  Voigt C;
  for (int v = 0; v < 6; ++v) C[v] = v < 3 ? 2.0 * strain.e[v] + 1.0 : strain.e[v];
  const Pack inverse_det = 1.0 / (strain.J * strain.J);
  strain.C_inverse[0] = (C[1] * C[2] - C[4] * C[4]) * inverse_det;
  strain.C_inverse[1] = (C[0] * C[2] - C[5] * C[5]) * inverse_det;
  strain.C_inverse[2] = (C[0] * C[1] - C[3] * C[3]) * inverse_det;
  strain.C_inverse[3] = (C[5] * C[4] - C[3] * C[2]) * inverse_det;
  strain.C_inverse[4] = (C[3] * C[5] - C[0] * C[4]) * inverse_det;
  strain.C_inverse[5] = (C[3] * C[4] - C[5] * C[1]) * inverse_det;
}

/// Adds an energy g(J). Since dJ/dgamma = J C^-1, its stress is g' C^-1.
template <bool with_tangent>
PALPATE_INLINE void addVolumetric(const VolumeFunction& g, const Voigt& Ci, Response& response) {
  response.energy += g.value;
  for (int v = 0; v < 6; ++v) response.S[v] += g.first * Ci[v];
  if constexpr (with_tangent)
    for (int v = 0; v < 6; ++v)
      for (int w = v; w < 6; ++w) {
        const int I = voigt_row[v], K = voigt_column[v], M = voigt_row[w], N = voigt_column[w];
        response.D[v][w] +=
            g.second * Ci[v] * Ci[w] - g.first * (Ci[voigt_of[I][M]] * Ci[voigt_of[K][N]] +
                                                  Ci[voigt_of[I][N]] * Ci[voigt_of[K][M]]);
        response.D[w][v] = response.D[v][w];
      }
}

/// Adds the energy -p c with the constraint c = tr gamma, which replaces lambda/2 (tr gamma)^2. The
/// stress of c is the identity, and its tangent is zero.
PALPATE_INLINE void addTraceConstraint(Pack p, Strain<Pack>& strain, Response& response) {
  const Pack trace = strain.e[0] + strain.e[1] + strain.e[2];
  response.constraint = {trace, Pack{} + 1.0, Pack{}};
  response.energy -= p * trace;
  for (int v = 0; v < 3; ++v) response.S[v] -= p;
  // The identity takes the place of C^-1 in the stress of the other constraints.
  for (int v = 0; v < 6; ++v) strain.C_inverse[v] = Pack{} + (v < 3 ? 1.0 : 0.0);
}

/// `mixed`: whether a pressure or a volumetric energy is added to the energy of the law.
template <bool with_tangent, bool mixed, class Law>
PALPATE_INLINE void respondAs(const Law& law, const ElementParameters& parameters,
                              const BatchGeometry& geometry, Pack p, Strain<Pack>& strain,
                              Response& response) {
  if constexpr (Law::needs_fibers)
    for (int family = 0; family < 2; ++family)
      for (int I = 0; I < 3; ++I) strain.fiber[family][I] = geometry.fiber[family][I];
  if constexpr (mixed || Law::needs_C_inverse) invertC(strain);
  law.evaluate(strain, response.energy, response.S);
  if constexpr (with_tangent) law.tangent(strain, response.D);
  if constexpr (mixed) {
    if (parameters.pressure == PressureSpace::none) {
      addVolumetric<with_tangent>(penaltyOf(parameters.bulk, strain.J), strain.C_inverse, response);
    } else {
      const VolumeFunction& c = response.constraint = constraintOf(parameters.constraint, strain.J);
      addVolumetric<with_tangent>({-p * c.value, -p * c.first, -p * c.second}, strain.C_inverse,
                                  response);
    }
  }
}

/// Computes the response of the material `m` at pressure p (Pa; ignored if the material has no
/// pressure). Also sets the members of `strain` that the law needs in addition to e and J.
template <bool with_tangent>
void respond(const ElementParameters& m, const BatchGeometry& geometry, Pack p,
             Strain<Pack>& __restrict strain, Response& __restrict response) {
  const auto displacementOnly = [&](const auto& law) {
    respondAs<with_tangent, false>(law, m, geometry, p, strain, response);
  };
  const auto mixed = [&](const auto& law) {
    respondAs<with_tangent, true>(law, m, geometry, p, strain, response);
  };
  switch (m.law) {
    case LawName::linear:  // strain.e is then the small strain
    case LawName::st_venant_kirchhoff:
      displacementOnly(StVenantKirchhoff{m.lambda, m.mu});
      if (m.pressure != PressureSpace::none) addTraceConstraint(p, strain, response);
      return;
    case LawName::modified_st_venant_kirchhoff: return mixed(StVenantKirchhoff{m.lambda, m.mu});
    case LawName::mooney_rivlin: return mixed(MooneyRivlin{{m.c10, m.c01}});
    case LawName::neo_hookean: return mixed(NeoHookean{{m.mu}});
    case LawName::yeoh: return mixed(Yeoh{{m.c10, m.c20, m.c30}});
    case LawName::ogden:
      return mixed(Ogden{{m.ogden_mu[0], m.ogden_mu[1], m.ogden_mu[2]},
                         {m.ogden_alpha[0], m.ogden_alpha[1], m.ogden_alpha[2]},
                         m.ogden_terms});
    case LawName::veronda_westmann: return mixed(VerondaWestmann{{m.c1, m.c2}});
    case LawName::holzapfel_gasser_ogden:
      return mixed(HolzapfelGasserOgden{{m.mu, m.k1, m.k2, m.dispersion}});
  }
}

}  // namespace palpate::PALPATE_KERNEL_NAMESPACE
