#pragma once

#include "common/space/failure.hpp"
#include "worker/solver/system.hpp"
#include "worker/solver/tangent_solver.hpp"

namespace palpate {

struct NewtonOptions {
  int max_iterations = 40;
  int max_factorizations = 6;
  int max_halvings = 6;  ///< of a step, by the line search
  /// Factorises a new tangent in each iteration. For stiffness that jumps, where Broyden's updates
  /// help little.
  bool renew_always = false;
  /// Also accepts a step if the next correction with the same tangent is smaller (natural
  /// monotonicity test; Deuflhard, Newton Methods for Nonlinear Problems, 2004). For bodies with a
  /// nearly rigid part, where a rotation increases the residual.
  bool affine_descent = false;
  /// A tangent is kept while each iteration reduces the residual to less than this share ...
  double slow_contraction = 0.5;
  /// ... or if, at the present rate, convergence takes at most this many iterations.
  int iterations_worth_a_tangent = 8;
  /// Converged if the residual norm is at most absolute * (System::forceScale() + totalLoad()) +
  /// relative * |force on the tool|. The force is then right to about 1e-9 relative.
  double absolute_tolerance = 1e-10;
  double relative_tolerance = 1e-9;
};

/// Returns why a state has no residual: an element is inverted (ln det F does not exist), or a
/// number overflowed; in the latter case det F may be NaN.
Cause causeOfNotFinite(const Residual& residual);

/// The state in which Newton ended, converged or not.
struct NewtonResult {
  Cause cause = Cause::none;  ///< none: converged
  State state;
  Residual residual;            ///< at `state`
  int iterations = 0;           ///< corrections of the state
  int factorizations = 0;       ///< the solver holds the last factors, if any
  Factorization factorization;  ///< the last one
};

/// Solves the equations with the tool at `displacement` (metres). `start` must already have the
/// tool there.
///
/// A quasi-Newton method. The tangent is factorised at the start, and its inverse is corrected
/// after every step by Broyden's rank-one update (Kelley, Iterative Methods for Linear and
/// Nonlinear Equations, 1995, Sec. 7.3). Slow convergence triggers a new tangent. The first step
/// with a new tangent is Newton's, with a line search that halves it until the residual norm
/// decreases. The line search uses the residual and not the energy, because with a pressure the
/// solution is a saddle point.
NewtonResult findEquilibrium(const System& system, TangentSolver& solver, State start,
                             const Eigen::Vector3d& displacement, const NewtonOptions& options);

/// Solves for the nodes around a rigid tool while all others keep their place in `state`.
///
/// A tool that moves by more than an element's size strains the elements beside it far more than
/// the rest of the body. Newton spends most of its tangents there, or inverts an element. Solving
/// the few equations near the tool first is nonlinear elimination (Lanzkron, Rose and Wilkes 1996;
/// Cai and Keyes 2002). The remaining problem of the whole body is smooth, and one tangent
/// suffices.
///
/// Newton with a line search and a dense matrix of the neighbourhood's size. If the residual norm
/// falls to `tolerance` (N), `state` becomes the solution and the result is true; otherwise `state`
/// is unchanged.
bool relaxNearTool(const System& system, const Neighborhood& neighborhood, State& state,
                   double tolerance);

}  // namespace palpate
