#pragma once

/// Strain energies W(gamma), with the second Piola-Kirchhoff stress S = dW/dgamma and the tangent D
/// = dS/dgamma. gamma = (F^T F - I)/2 is the Green strain; for linear elasticity it is the small
/// strain. Moduli in Pa. Conventions are in worker/laws/strain.hpp, derivations in
/// worker/laws/invariants.hpp and worker/laws/ogden.hpp.
///
/// A law is a class with
///
///   static constexpr bool needs_C_inverse;  // reads Strain::C_inverse and J
///   static constexpr bool needs_fibers;     // reads Strain::fiber
///   template <class T> void evaluate(const Strain<T>&, T& W, T (&S)[6]) const;
///   template <class T> void tangent(const Strain<T>&, T (&D)[6][6]) const;
///
/// All laws except StVenantKirchhoff are isochoric: they depend on J^(-2/3) C alone. They need the
/// constraint det F = 1 or an additional volumetricEnergy. j1 = J^(-2/3) tr C, j2 = J^(-4/3) ((tr
/// C)^2 - C:C)/2.
#include "worker/laws/invariant_laws.hpp"
#include "worker/laws/ogden.hpp"
#include "worker/laws/st_venant_kirchhoff.hpp"
