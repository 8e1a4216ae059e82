#pragma once

#include <optional>

#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

/// Finds the direction in which a body leaves an unstable equilibrium. It is the eigenvector of the
/// tangent's most negative eigenvalue, sought among the four eigenvalues nearest to zero. The tool
/// stays in place, and a body with a pressure keeps its volume.
///
/// Returns a vector over the unknowns, pressures included. It is scaled so that the displacement
/// component of largest magnitude is +1 m (if several are equal, the first in node order). Empty if
/// no eigenvalue near zero is negative, or if MUMPS reports an error.
///
/// Inverse subspace iteration (Bathe, Finite Element Procedures, 1996, Sec. 11.6). Costs one
/// factorisation of the tangent at `state`, whose factors stay in `solver`.
std::optional<Eigen::VectorXd> criticalMode(const System& system, TangentSolver& solver,
                                            const State& state);

}  // namespace palpate
