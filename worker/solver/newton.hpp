#pragma once

#include "common/space/failure.hpp"
#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

struct NewtonOptions {
  int max_iterations = 40;
  int max_factorizations = 6;
  int max_halvings = 6;  ///< of a step by the line search
  /// Takes a new tangent in each iteration: for bodies whose stiffness jumps, where Broyden's
  /// updates help little.
  bool renew_always = false;
  /// Also accepts a step if the next correction with the same tangent is smaller (natural
  /// monotonicity test; Deuflhard, Newton Methods for Nonlinear Problems, 2004): for bodies with a
  /// nearly rigid part, where a rotation increases the residual.
  bool affine_descent = false;
  /// A tangent is kept while the residual falls to less than this in each iteration ...
  double slow_contraction = 0.5;
  /// ... or when at that rate it is done after no more iterations than a new tangent is worth.
  int iterations_worth_a_tangent = 8;
  /// Converged when the residual norm is at most absolute * (System::forceScale() + totalLoad()) +
  /// relative * |force on the tool|. Leaves the force right to about 1e-9 relative.
  double absolute_tolerance = 1e-10;
  double relative_tolerance = 1e-9;
};

/// Why a state has no residual: an element is inverted (ln det F does not exist), or something
/// overflowed, and then det F may be NaN.
Cause causeOfNotFinite(const Residual& residual);

/// Where Newton ended, converged or not.
struct NewtonResult {
  Cause cause = Cause::none;  ///< none: converged
  State state;
  Residual residual;            ///< at `state`
  int iterations = 0;           ///< corrections of the state
  int factorizations = 0;       ///< the solver holds the last one, when there was any
  Factorization factorization;  ///< the last one
};

/// Solves the equations for the tool at `displacement` (metres), from `start`, which has the tool
/// there already.
///
/// A quasi-Newton method: the tangent is factorised where it starts, and its inverse corrected
/// after every step by Broyden's rank-one update (Kelley, Iterative Methods for Linear and
/// Nonlinear Equations, 1995, Sec. 7.3); when that converges slowly the tangent is taken anew. The
/// first step with a new tangent is Newton's, with a line search that halves it until the norm of
/// the residual decreases. It watches the residual and not the energy because with a pressure the
/// solution is a saddle point.
NewtonResult findEquilibrium(const System& system, TangentSolver& solver, State start,
                             const Eigen::Vector3d& displacement, const NewtonOptions& options);

/// Brings the nodes around a rigid tool to equilibrium while everything else is held where `state`
/// has it.
///
/// A tool that moves by more than an element's size strains the elements beside it far beyond the
/// rest of the body; Newton spends most of its tangents there, or inverts one of them. Solving the
/// few equations near the tool first is nonlinear elimination (Lanzkron, Rose and Wilkes 1996; Cai
/// and Keyes 2002): what is left for the whole body is smooth, and one tangent suffices.
///
/// Newton with a line search and a dense matrix of the neighbourhood's size. `state` becomes the
/// solution when the residual norm falls to `tolerance` (N), which is returned as true, and is
/// unchanged otherwise.
bool relaxNearTool(const System& system, const Neighborhood& neighborhood, State& state,
                   double tolerance);

}  // namespace palpate
