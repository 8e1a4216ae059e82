#pragma once

#include <optional>

#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

/// The displacement in which a body leaves an unstable equilibrium by itself: the eigenvector of
/// the tangent's most negative eigenvalue, of the four nearest to zero, among displacements that
/// keep the volume where a pressure does and the tool where it is. A vector over the unknowns, with
/// the pressures that go along; the largest displacement is +1 m, the first in the order of the
/// nodes where several are as large.
///
/// By subspace iteration with the inverse (Bathe, Finite Element Procedures, 1996, Sec. 11.6), one
/// factorisation; `solver` then has that of the tangent at `state`. Nothing when the tangent has no
/// negative eigenvalue near zero, or MUMPS reports an error.
std::optional<Eigen::VectorXd> criticalMode(const System& system, TangentSolver& solver,
                                            const State& state);

}  // namespace palpate
