#pragma once

#include <Eigen/Core>

#include "common/failure.hpp"
#include "worker/linear_solver.hpp"
#include "worker/system.hpp"

namespace palpate {

struct NewtonOptions {
  int max_iterations = 15;  ///< the tangent predictor leaves 3 to 5 for a lattice step of an element size
  int max_halvings = 6;     ///< of one Newton step by the line search
  /// Converged when the residual norm is at most absolute * System::forceScale() + relative * |force on the
  /// tool|. Newton is quadratic here, so these leave the force right to about 1e-9 relative.
  double absolute_tolerance = 1e-10;
  double relative_tolerance = 1e-9;
};

/// Where Newton ended, converged or not.
struct NewtonResult {
  Cause cause = Cause::none;  ///< none: converged
  State state;
  Residual residual;            ///< at `state`
  Tangent tangent;              ///< at `state`, not factorised
  int iterations = 0;           ///< equal to the factorisations that were spent
  Factorization factorization;  ///< the last one
};

/// Solves the equations for the tool at `displacement` (metres), from `start`, which has the tool there
/// already.
///
/// Full Newton; the line search halves the step until the norm of the residual decreases. It watches the
/// residual and not the energy because with a pressure the solution is a saddle point.
NewtonResult findEquilibrium(const System& system, LinearSolver& solver, State start,
                             const Eigen::Vector3d& displacement, const NewtonOptions& options);

}  // namespace palpate
