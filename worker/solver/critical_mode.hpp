#pragma once

#include <optional>

#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

/// Finds the direction in which a body leaves an unstable equilibrium: the eigenvector of the
/// tangent's most negative eigenvalue among the four nearest to zero. The tool stays in place, and
/// a body with a pressure keeps its volume.
///
/// Returns a vector over the unknowns, pressures included, scaled so that the largest displacement
/// is +1 m (the first in node order if several are equal). Empty if no eigenvalue near zero is
/// negative, or if MUMPS reports an error.
///
/// Inverse subspace iteration (Bathe, Finite Element Procedures, 1996, Sec. 11.6). Costs one
/// factorisation, of the tangent at `state`; its factors stay in `solver`.
std::optional<Eigen::VectorXd> criticalMode(const System& system, TangentSolver& solver,
                                            const State& state);

}  // namespace palpate
